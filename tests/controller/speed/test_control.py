"""Speed control by itself: times of plans, shape of the motion and its limits, with a planner that counts."""

from dataclasses import replace

import numpy as np
import pytest

from foreride.controller.interface import Estimate
from foreride.controller.speed import control
from foreride.controller.speed.control import SpeedControl
from foreride.controller.speed.settings import ReactiveBraking
from foreride.preview.road_preview import RoadPreview
from foreride.vehicle.speed_profile import SpeedProfile
from tests.controller.cars import estimate
from tests.vehicle.plant.short_drives import FLAT, HALF, drive

STATE = replace(drive(HALF, [FLAT, FLAT], 9.0, 1), x_m=np.array(4.0), speed_m_s=np.array(8.0))


class Steady:
    """Planner of one jerk, which counts what it is asked."""

    def __init__(self, jerk: float) -> None:
        self._jerk, self.felt, self.planned = jerk, 0, 0

    def feel(self, estimate: Estimate) -> None:
        self.felt += 1

    def jerk(self, estimate: Estimate, preview: RoadPreview | None) -> float:
        self.planned += 1
        return self._jerk


def controlled(
    monkeypatch: pytest.MonkeyPatch, jerk: float, period_s: float, periods: int
) -> tuple[Steady, list[SpeedProfile | None], list[float]]:
    """Planner, motions and accelerations at the start of each period, of a control with a steady jerk."""
    planner = Steady(jerk)
    monkeypatch.setattr(control, "build_planner", lambda *_: planner)
    speed = SpeedControl(ReactiveBraking(), HALF, 9.0, 3.0, period_s)
    profiles, accelerations = [], []
    for period in range(periods):
        accelerations.append(speed.forward_acc)
        profiles.append(speed.step(estimate(HALF), None, 7 * period, STATE))
    return planner, profiles, accelerations


@pytest.mark.parametrize(("period_s", "every"), [(0.005, 10), (0.02, 3), (0.05, 1), (0.1, 1)])
def test_a_plan_is_made_each_twentieth_of_a_second_rounded_up_to_periods(
    monkeypatch: pytest.MonkeyPatch, period_s: float, every: int
) -> None:
    planner, profiles, _ = controlled(monkeypatch, -1.0, period_s, 4 * every)
    assert (planner.felt, planner.planned) == (4 * every, 4)
    assert [profile is not None for profile in profiles] == ([True] + [False] * (every - 1)) * 4


def test_the_jerk_is_held_until_the_next_plan_and_the_acceleration_within_the_limits(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Plans every 0.06 s in pieces of 5 ms, from the car's own speed, place and tick on."""
    _, profiles, accelerations = controlled(monkeypatch, -4.0, 0.02, 60)
    expected = np.maximum(-4.0 * 0.02 * np.arange(60), -3.0)
    np.testing.assert_allclose(accelerations[1:], expected[1:], atol=1e-12)
    first, second = profiles[0], profiles[3]
    assert first is not None
    assert second is not None
    np.testing.assert_allclose(first.times_s, 0.005 * np.arange(13))
    at_s = 0.005 * np.arange(13)
    np.testing.assert_allclose(first.speeds_m_s, 8.0 - 0.5 * 4.0 * at_s**2)
    np.testing.assert_allclose(second.speeds_m_s, 8.0 - 4.0 * 0.06 * at_s - 0.5 * 4.0 * at_s**2)
    assert (first.start_m, first.start_tick, second.start_tick) == (4.0, 0, 21)


def test_it_accelerates_no_more_than_allowed(monkeypatch: pytest.MonkeyPatch) -> None:
    assert controlled(monkeypatch, 5.0, 0.05, 20)[2][-1] == 2.0
