"""Tests of the fallback supervisor: selection under each fault and bumpless transfer."""

from dataclasses import replace

import numpy as np
import pytest

import foreride.controller.mpc.program as program
from foreride.controller.interface import ALL_SILENT, BaseController, Estimate, MonitoredController, Timing
from foreride.controller.mpc.qp import Solution
from foreride.controller.registry import build
from foreride.controller.settings import ControllerSettings, SupervisorSettings
from foreride.controller.supervision.preview_gate import INCONSISTENT
from foreride.controller.supervision.supervisor import FallbackSupervisor, relief_m
from foreride.controller.tuned_settings import tuned_settings
from foreride.files.errors import InputError
from foreride.preview.road_preview import RoadPreview
from foreride.vehicle.load import load_vehicle
from tests.controller.cars import estimate, step_preview

CAR = load_vehicle("quarter")
AT_ONCE = replace(tuned_settings("quarter_car"), supervisor=SupervisorSettings(transfer_s=0.0))
MOVING = estimate(CAR, np.array([0.01, 0.3, -0.01, -0.4, 1500.0]))


class Told(BaseController):
    """Controller stub with prescribed answers, which records its inputs."""

    def __init__(self, answer: float) -> None:
        self.answer = answer
        self.previews: list[RoadPreview | None] = []
        self.took_over: list[float] = []

    def reset(self) -> None:
        pass

    def step(self, estimate: Estimate, preview: RoadPreview | None) -> np.ndarray:
        self.previews.append(preview)
        return np.array([self.answer])

    def acted(self, command: np.ndarray) -> None:
        self.took_over.append(float(command[0]))


def watched(inner: MonitoredController, settings: ControllerSettings = AT_ONCE) -> FallbackSupervisor:
    reactive, safe = build("skyhook", CAR, settings)._controller, build("fixed", CAR, settings)  # type: ignore[attr-defined]
    return FallbackSupervisor(inner, reactive, safe, CAR, settings.supervisor, Timing(0.005))


def reactive() -> np.ndarray:
    return build("skyhook", CAR, AT_ONCE).step(MOVING, None)


def test_a_sound_answer_passes() -> None:
    supervised = watched(Told(777.0))
    np.testing.assert_array_equal(supervised.step(MOVING, None), [777.0])
    assert supervised.problem is None
    assert (supervised.stats["solves"], supervised.stats["fallbacks"]) == (1, 0)


@pytest.mark.parametrize("fault", ["rattle_m_0 stuck", "late answer"])
def test_a_fault_brings_the_reactive_law_in_the_same_sample(fault: str) -> None:
    supervised = watched(Told(777.0))
    supervised.step(MOVING, None)
    np.testing.assert_array_equal(supervised.step(replace(MOVING, faults=(fault,)), None), reactive())
    assert supervised.problem == fault
    np.testing.assert_array_equal(supervised.step(MOVING, None), [777.0])
    assert supervised.stats["reasons"] == {fault: 1}


def test_a_solver_that_fails_and_an_answer_that_is_no_number_do_so_too() -> None:
    inner = Told(float("nan"))
    supervised = watched(inner)
    np.testing.assert_array_equal(supervised.step(MOVING, None), reactive())
    inner.answer, inner.problem = 900.0, "infeasible"  # type: ignore[assignment]
    np.testing.assert_array_equal(supervised.step(MOVING, None), reactive())
    assert supervised.stats["reasons"] == {"command not finite": 1, "infeasible": 1}


@pytest.mark.parametrize("broken", [replace(MOVING, faults=(ALL_SILENT,)), estimate(CAR, np.full(5, np.nan))])
def test_who_knows_nothing_of_the_car_leaves_the_dampers_fixed(broken: Estimate) -> None:
    supervised = watched(Told(777.0))
    fixed = AT_ONCE.fixed.front_ns_m
    np.testing.assert_array_equal(supervised.step(broken, None), [fixed])
    np.testing.assert_array_equal(supervised.step(MOVING, None), [777.0])


@pytest.mark.parametrize(
    ("spoilt", "named"),
    [
        (replace(step_preview(0.5, 0.05), age_s=2.0), "stale preview"),
        (replace(step_preview(0.5, 0.05), time_s=-0.2), "stale preview"),
        (step_preview(0.5, 3.0), "absurd preview"),
        (step_preview(0.5, 0.05, wheels=2), "preview of another car"),
    ],
)
def test_a_preview_that_cannot_be_believed_is_taken_away(spoilt: RoadPreview, named: str) -> None:
    inner = Told(777.0)
    supervised, sound = watched(inner), step_preview(0.5, 0.05)
    for preview in (sound, spoilt):
        np.testing.assert_array_equal(supervised.step(MOVING, preview), [777.0])
    assert inner.previews == [sound, None]
    assert supervised.problem == named


def test_a_preview_that_the_road_contradicts_is_taken_away() -> None:
    """A step of 8 cm announced at the wheel, where the road stays flat."""
    inner = Told(777.0)
    supervised = watched(inner)
    for k in range(40):
        now = replace(MOVING, time_s=0.005 * k)
        preview = replace(step_preview(1.0 - 0.05 * k, 0.08), time_s=now.time_s)
        np.testing.assert_array_equal(supervised.step(now, preview), [777.0])
    assert inner.previews[19] is not None
    assert inner.previews[-1] is None
    assert supervised.problem == INCONSISTENT
    assert supervised.stats["reasons"] == {INCONSISTENT: inner.previews.count(None)}


def test_changes_are_bumpless() -> None:
    """From 4000 to the reactive law and back: the step decays by 1/e per transfer time."""
    settings = replace(AT_ONCE, supervisor=SupervisorSettings(transfer_s=0.005))
    supervised, faulty = watched(Told(4000.0), settings), replace(MOVING, faults=("late answer",))
    target = float(reactive()[0])
    supervised.step(MOVING, None)
    seen = [float(supervised.step(faulty, None)[0]) for _ in range(4)]
    np.testing.assert_allclose(seen, target + (4000.0 - target) * np.exp(-np.arange(1.0, 5.0)), rtol=1e-3)
    back = [float(supervised.step(MOVING, None)[0]) for _ in range(4)]
    np.testing.assert_allclose(back, 4000.0 + (seen[-1] - 4000.0) * np.exp(-np.arange(1.0, 5.0)), rtol=1e-3)


def test_the_controller_is_told_what_acted() -> None:
    inner = Told(777.0)
    supervised = watched(inner)
    supervised.step(MOVING, None)
    supervised.step(replace(MOVING, faults=("late answer",)), None)
    assert inner.took_over == [777.0, float(reactive()[0])]


def test_every_law_with_memory_of_nothing_can_be_the_reactive_one() -> None:
    for law in ("skyhook", "skyhook2", "groundhook", "hybrid", "add", "sh_add", "pdd"):
        settings = replace(AT_ONCE, supervisor=SupervisorSettings(reactive=law, transfer_s=0.0))  # type: ignore[arg-type]
        alone, under = build(law, CAR, settings), build("mpc_reactive", CAR, settings)
        faulty = replace(MOVING, faults=("late answer",))
        np.testing.assert_array_equal(under.step(faulty, None), alone.step(MOVING, None))


def test_the_mpc_falls_back_when_its_solver_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(program, "solve_stages", lambda *_: None)
    monkeypatch.setattr(
        program, "solve_box", lambda h, g, low, high, rows: Solution(np.zeros_like(g), "infeasible")
    )
    supervised = build("mpc_preview", CAR, AT_ONCE)
    np.testing.assert_array_equal(supervised.step(MOVING, None), reactive())
    assert supervised.stats["reasons"] == {"infeasible": 1}  # type: ignore[attr-defined]


def test_run_times_are_told_but_there_are_none_before_the_first_step() -> None:
    supervised = watched(Told(777.0))
    assert supervised.stats["median_ms"] is None
    supervised.step(MOVING, None)
    assert 0.0 < supervised.stats["median_ms"] <= supervised.stats["max_ms"]


def test_a_command_for_another_number_of_wheels_is_refused() -> None:
    half, inner = load_vehicle("half"), Told(777.0)
    supervised = FallbackSupervisor(inner, inner, inner, half, SupervisorSettings(), Timing())
    with pytest.raises(InputError, match=r"command must have shape \(2,\), got \(1,\)"):
        supervised.step(estimate(half), None)


@pytest.mark.parametrize("seed", range(3))
def test_the_relief_is_the_departure_from_straight_lines_or_the_rise_within_a_metre(seed: int) -> None:
    """By a fitted line for each wheel; a grade is no relief, but for its rise within a metre."""
    rng, grid = np.random.default_rng(seed), np.linspace(-0.5, 6.0, 53)
    rows = np.cumsum(0.03 * rng.normal(size=(2, len(grid))), axis=1) + np.outer([0.05, -0.02], grid)
    departures = [row - np.polyval(np.polyfit(grid, row, 1), grid) for row in rows]
    rises = rows[:, 8:] - rows[:, :-8]
    zero = np.zeros_like(rows)
    found = relief_m(grid, rows)
    assert found == pytest.approx(max(np.abs(departures).max(), np.abs(rises).max()))
    grade = RoadPreview(0.0, grid, np.tile(-0.1 * grid, (2, 1)), zero, zero, zero)
    assert relief_m(grade.distance_m, grade.height_m) == pytest.approx(0.1)
