"""Search from several starts on a function with two minima, and the replay of a plan."""

import numpy as np
import pytest

from foreride.controller.clairvoyant.optimum import Optimum, PlanReplay, optimise
from foreride.vehicle.load import load_vehicle
from tests.controller.cars import estimate

QUARTER, HALF = load_vehicle("quarter"), load_vehicle("half")


class TwoValleys:
    """J with minima near 1 and 3 kN·s/m in each interval, the lower one near 1; `plans` as they are asked."""

    intervals = 3

    def __init__(self) -> None:
        self.plans: list[np.ndarray] = []

    def objective(self, plan: np.ndarray) -> tuple[float, np.ndarray]:
        self.plans.append(np.array(plan))
        below, above = plan - 1.0, plan - 3.0
        value = 5.0 + np.sum(below**2 * above**2 + 0.1 * plan)
        slope = 2.0 * below * above**2 + 2.0 * below**2 * above + 0.1
        return float(value), slope


@pytest.mark.parametrize("order", [("high", "low"), ("low", "high")])
def test_the_best_of_all_starts_is_returned_whatever_their_order(order: tuple[str, str]) -> None:
    starts = {"high": np.full((3, 1), 3.3), "low": np.full((3, 1), 0.8)}
    found = optimise(QUARTER, TwoValleys(), {name: starts[name] for name in order})  # type: ignore[arg-type]
    assert found.plan.shape == (3, 1)
    np.testing.assert_allclose(found.plan, 0.987, atol=0.003)
    assert found.objective == found.objectives["low"] < found.objectives["high"]
    assert found.gap == pytest.approx(found.objectives["high"] / found.objectives["low"] - 1.0)


def test_no_plan_leaves_the_dampers_range() -> None:
    drive = TwoValleys()
    optimise(HALF, drive, {"outside": np.full((3, 2), 9.0)})  # type: ignore[arg-type]
    low, high = HALF.damping_min_ns_m[0] / 1e3, HALF.damping_max_ns_m[0] / 1e3
    for plan in drive.plans[1:]:
        assert (plan > low).all()
        assert (plan < high).all()


def test_the_gap_of_a_single_start_is_zero() -> None:
    assert Optimum(np.ones((2, 1)), 0.5, {"one": 0.5}).gap == 0.0


def test_a_plan_is_replayed_in_turn_and_its_last_command_held() -> None:
    replay = PlanReplay(np.array([[1.0, 2.0], [0.5, 0.7]]))
    commands = [replay.step(estimate(HALF), None) for _ in range(4)]
    np.testing.assert_allclose(commands, [[1000.0, 2000.0], *[[500.0, 700.0]] * 3])
    replay.reset()
    np.testing.assert_allclose(replay.step(estimate(HALF), None), [1000.0, 2000.0])
