"""Grades: a climb is no heave, so J is that of the level road, and no preview is refused."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from foreride.scenarios.cases import Case
from foreride.scenarios.definition.loading import load
from foreride.scenarios.simulation.simulate import Run, simulate

LENGTH_M = 70.0


def slope_file(folder: Path, grade: float, bank: float = 0.0) -> str:
    """CSV road of constant grade and bank."""
    x = np.linspace(0.0, LENGTH_M, 141)
    rows = [f"{s:.2f},{grade * s + 0.75 * bank:.6f},{grade * s - 0.75 * bank:.6f}" for s in x]
    path = folder / "slope.csv"
    path.write_text("x_m,left_m,right_m\n" + "\n".join(rows) + "\n")
    return str(path)


def driven(
    controller: str, perception: str, vehicle: str, plan: dict[str, float] | None = None, **road: Any
) -> Run:
    fields = {f"road.{name}": value for name, value in road.items()}
    fields |= {f"control.settings.mpc.{name}": value for name, value in (plan or {}).items()}
    base = {"vehicle.model": vehicle, "speed_kmh": 60.0, "road.length_m": LENGTH_M}
    return simulate(Case(load("rough_b_80", base | fields), controller, perception, 0))


LADDER = [("passive", "none"), ("skyhook", "none"), ("mpc_reactive", "none"), ("mpc_preview", "oracle")]


@pytest.mark.parametrize(("controller", "perception"), LADDER)
def test_a_file_with_four_percent_left_in_rides_like_the_level_road(
    controller: str, perception: str, tmp_path: Path
) -> None:
    level = driven(controller, perception, "quarter")
    climbing = driven(controller, perception, "quarter", file=slope_file(tmp_path, 0.04))
    assert climbing.metrics["objective"] == pytest.approx(level.metrics["objective"], rel=0.01)
    assert climbing.metrics["rattle_peak"] == pytest.approx(level.metrics["rattle_peak"], rel=0.03)
    assert (climbing.solver.get("fallbacks") or 0) == 0


SHORT_PLAN = {"horizon_s": 0.3, "fine_s": 0.2}


@pytest.mark.parametrize(
    ("controller", "perception", "plan", "lost"),
    [(*LADDER[2], {}, 0.15), (*LADDER[3], SHORT_PLAN, 0.05), (*LADDER[3], {}, 0.08)],
)
def test_a_vertical_curve_is_no_heave_and_no_preview_of_it_is_refused(
    controller: str, perception: str, plan: dict[str, float], lost: float
) -> None:
    """The whole drive is on the curve, of 0.14 m/s²; its height over the plane grows with the plan."""
    curve = [{"start_m": 5.0, "grade": -0.03, "length_m": 60.0}]
    level = driven(controller, perception, "quarter", plan)
    falling = driven(controller, perception, "quarter", plan, grades=curve)
    assert falling.solver["fallbacks"] == 0
    assert falling.metrics["objective"] == pytest.approx(level.metrics["objective"], rel=lost)


def test_no_preview_of_a_hill_with_a_sharp_foot_is_refused() -> None:
    foot = [{"start_m": 10.0, "grade": 0.06, "length_m": 4.0}]
    assert driven("mpc_preview", "oracle", "quarter", grades=foot).solver["fallbacks"] == 0


def test_a_full_car_rides_a_bank_like_the_level_road(tmp_path: Path) -> None:
    level = driven("skyhook", "none", "full")
    banked = driven("skyhook", "none", "full", file=slope_file(tmp_path, 0.0, bank=0.03))
    assert banked.metrics["objective"] == pytest.approx(level.metrics["objective"], rel=0.01)


@pytest.mark.parametrize("grade", [-0.06, 0.04])
def test_a_car_starts_in_equilibrium_on_a_slope(grade: float, tmp_path: Path) -> None:
    smooth = driven("passive", "none", "half", file=slope_file(tmp_path, grade), roughness=None)
    assert np.abs(smooth.signals["seat_acc_0"]).max() < 5e-3
    assert np.abs(smooth.signals["rattle_m_0"]).max() < 1e-4
    assert smooth.metrics["stop_time"] == 0.0
