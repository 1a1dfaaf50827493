"""Speed planners on one estimate after another, and the motion that the control makes of their jerks."""

from dataclasses import replace

import numpy as np
import pytest

from foreride.comfort.weighting import wk_second_order
from foreride.controller.interface import Estimate
from foreride.controller.speed.control import SpeedControl
from foreride.controller.speed.planner import PreviewPlanning, _spread, build_planner, jerk_towards
from foreride.controller.speed.settings import PreviewPlanner, ReactiveBraking, SpeedPlanner
from foreride.preview.road_preview import RoadPreview, distance_grid, flat_preview
from foreride.vehicle.plant.plant import Plant
from foreride.vehicle.speed_profile import SpeedProfile
from foreride.vehicle.state import VehicleState
from tests.controller.cars import estimate
from tests.vehicle.plant.short_drives import FLAT, HALF

CRUISE = 9.0
GRID = distance_grid(ahead_m=30.0)


def seen(bump_m: float, x_m: float) -> RoadPreview:
    """Preview at x_m of a bump of 10 cm over half a metre at bump_m."""
    flat = flat_preview(2, distance_m=GRID)
    heights = [
        0.1 * np.sin(np.pi * np.clip((GRID + x_m + axle - bump_m) / 0.5, 0.0, 1.0)) for axle in HALF.axle_x_m
    ]
    return replace(flat, height_m=np.array(heights), existence=np.ones((2, len(GRID))))


def driven(settings: SpeedPlanner, bump_m: float, ticks: int) -> VehicleState:
    """Plant on a flat road that follows the control, every 5 ms; the preview shows a bump."""
    plant, control = Plant(HALF), SpeedControl(settings, HALF, CRUISE, 3.0, 0.005)
    plant.reset([FLAT, FLAT], 0.0, CRUISE)
    for tick in range(0, ticks, 5):
        state = plant.state
        now = replace(_estimate(float(state.speed_m_s)), forward_acc=control.forward_acc)
        profile = control.step(now, seen(bump_m, float(state.x_m)), tick, state)
        if profile is not None:
            plant.follow(profile)
        plant.step([1500.0, 1500.0], 5)
    return plant.signals


def _estimate(speed_m_s: float) -> Estimate:
    return estimate(HALF, speed_m_s=speed_m_s)


def test_the_car_is_slow_over_the_bump_and_fast_elsewhere_within_the_limits() -> None:
    settings = PreviewPlanner(time_weight=0.5, max_deceleration_m_s2=2.0, max_jerk_m_s3=4.0)
    signals = driven(settings, 30.0, 6500)
    place, speed, acceleration = signals.x_m, signals.speed_m_s, signals.forward_acc
    assert 25.0 < place[speed.argmin()] < 33.0
    assert speed.min() < 0.7 * CRUISE
    assert speed[place < 3.0].min() > 0.98 * CRUISE
    assert speed.max() < CRUISE + 0.1
    assert acceleration.min() >= -2.0
    assert acceleration.max() <= settings.max_acceleration_m_s2
    steps = np.abs(np.diff(acceleration))
    assert steps.max() <= 4.0 * 0.005 * 1.01  # by pieces of 5 ms
    np.testing.assert_allclose(np.diff(place), 1e-3 * 0.5 * (speed[1:] + speed[:-1]), atol=1e-9)


@pytest.mark.parametrize("settings", [PreviewPlanner(), ReactiveBraking()])
def test_without_an_obstacle_the_cruising_speed_is_held(settings: SpeedPlanner) -> None:
    planner = build_planner(settings, HALF, CRUISE, 3.0, 0.005)
    for preview in (None, flat_preview(2, distance_m=GRID)):
        planner.feel(_estimate(CRUISE))
        assert planner.jerk(_estimate(CRUISE), preview) == 0.0


def test_an_unlikely_obstacle_slows_down_less() -> None:
    sure, unlikely = seen(12.0, 0.0), replace(seen(12.0, 0.0), existence=np.full((2, len(GRID)), 0.02))
    planner = build_planner(PreviewPlanner(time_weight=0.3), HALF, CRUISE, 3.0, 0.005)
    assert planner.jerk(_estimate(CRUISE), sure) < 0.0
    assert planner.jerk(_estimate(CRUISE), unlikely) == 0.0


def test_reactive_braking_follows_the_felt_ride() -> None:
    planner = build_planner(ReactiveBraking(), HALF, CRUISE, 3.0, 0.005)
    x = _estimate(CRUISE).x
    for step in range(200):
        moved = x.copy()
        moved[1] = 0.4 * np.sin(2 * np.pi * 6.0 * 0.005 * step)
        planner.feel(replace(_estimate(CRUISE), x=moved))
    assert planner.jerk(_estimate(CRUISE), None) < 0.0
    for _ in range(1000):
        planner.feel(_estimate(CRUISE))
    assert planner.jerk(_estimate(CRUISE - 3.0), None) > 0.0


def test_jerk_towards_a_speed_reaches_it_without_overshoot() -> None:
    settings, speed, acceleration, course = ReactiveBraking(), CRUISE, 0.0, []
    for _ in range(120):
        jerk = jerk_towards(5.0, speed, acceleration, settings)
        after = float(np.clip(acceleration + 0.05 * jerk, -3.0, 2.0))
        speed, acceleration = speed + 0.025 * (acceleration + after), after
        course.append(speed)
    assert min(course) > 4.8
    assert course[-1] == pytest.approx(5.0, abs=0.1)


def test_a_profile_may_start_at_any_tick() -> None:
    profile = SpeedProfile((0.0, 1.0), (5.0, 7.0), 20.0, start_tick=400)
    same = SpeedProfile((0.0, 1.0), (5.0, 7.0), 20.0)
    np.testing.assert_array_equal(profile.ahead(0.0, 900, 10).edges_m, same.ahead(0.0, 500, 10).edges_m)


@pytest.mark.parametrize(
    ("missing", "acceleration", "jerk"),
    [
        (0.004, 0.0, np.sqrt(5.0 * 0.004) / 0.1),
        (-0.004, 0.0, -np.sqrt(5.0 * 0.004) / 0.1),
        (4.0, 1.8, (2.0 - 1.8) / 0.1),
        (-4.0, -2.9, (-3.0 + 2.9) / 0.1),
        (4.0, -1.0, 5.0),
        (-4.0, 1.0, -5.0),
        (0.0, 0.3, -3.0),
    ],
)
def test_the_acceleration_sought_can_be_taken_back_in_time(
    missing: float, acceleration: float, jerk: float
) -> None:
    """Root of twice half the jerk of 5 m/s³ times the missing speed, -3 to 2 m/s², reached in 0.1 s."""
    assert jerk_towards(8.0 + missing, 8.0, acceleration, ReactiveBraking()) == pytest.approx(jerk)


@pytest.mark.parametrize(("roughness", "target"), [(1.0, CRUISE), (2.0, CRUISE / 2.0), (9.0, 10.0 / 3.6)])
def test_the_speed_is_divided_by_the_felt_over_the_comfortable_ride(roughness: float, target: float) -> None:
    """A steady sine at the seats, roughness times 0.8 m/s² weighted; 10 km/h at least."""
    planner = build_planner(ReactiveBraking(memory_s=5.0), HALF, CRUISE, 3.0, 0.005)
    x, omega = _estimate(CRUISE).x, 2 * np.pi * 4.0
    velocity = roughness * np.sqrt(2.0) * 0.8 / wk_second_order().magnitude(4.0) / omega
    for step in range(6000):
        moved = x.copy()
        moved[1] = velocity * np.sin(omega * 0.005 * step)
        planner.feel(replace(_estimate(CRUISE), x=moved))
    assert planner.jerk(_estimate(1.04 * target), None) < 0.0
    assert planner.jerk(_estimate(0.96 * target), None) > 0.0


def test_the_place_of_a_cost_is_spread_and_its_sum_kept() -> None:
    """Standard deviation: that of the preview, at least half a metre."""
    ride = np.zeros((100, 2))
    ride[50] = 1.0, 3.0
    at_m = 0.1 * (np.arange(100) + 0.5)
    for sigma, seen_sigma in ((0.0, 0.5), (0.2, 0.5), (1.2, 1.2)):
        preview = replace(seen(50.0, 0.0), position_sigma_m=np.full((2, len(GRID)), sigma))
        spread = _spread(ride, preview, 10.0)
        np.testing.assert_allclose(spread.sum(axis=0), [1.0, 3.0])
        np.testing.assert_allclose(spread[:, 1], 3.0 * spread[:, 0])
        share = spread[:, 0]
        assert share @ at_m == pytest.approx(5.05, abs=1e-3)
        assert np.sqrt(share @ (at_m - 5.05) ** 2) == pytest.approx(seen_sigma, rel=0.02)


def test_stretches_are_whole_pieces_of_a_twentieth_of_a_second_and_half_a_metre_at_least() -> None:
    for cruise, step_m in ((6.0, 0.5), (13.0, 0.6), (30.0, 1.5)):
        planning = PreviewPlanning(HALF, cruise, PreviewPlanner(), 3.0)
        grid = planning._program.grid
        assert grid.step_m == pytest.approx(step_m)
        assert grid.speeds[[0, -1]] == pytest.approx([10.0 / 3.6, cruise])
        assert (grid.accelerations.min(), grid.accelerations.max()) == (-3.0, 2.0)
    assert PreviewPlanning(HALF, 3.0, PreviewPlanner(), 3.0)._program.grid.speeds[0] == pytest.approx(2.7)
