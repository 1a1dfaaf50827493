from dataclasses import replace

import numpy as np
import pytest

from foreride.controller.interface import Timing
from foreride.controller.mpc.controller import PredictiveController
from foreride.controller.road_ahead.axle_fusion import fuse, previewed_variance
from foreride.controller.road_ahead.credible_heights import exact
from foreride.controller.road_ahead.road_reference import RoadReference
from foreride.controller.road_ahead.wheelbase_preview import WheelbasePreview
from foreride.controller.settings import MpcSettings, RoadSettings
from foreride.preview.road_preview import RoadPreview, distance_grid, flat_preview
from foreride.vehicle.load import load_vehicle
from tests.controller.cars import estimate

HALF, FULL = load_vehicle("half"), load_vehicle("full")
GRID = distance_grid(0.5, 6.0, 0.025)
SPEED, WHEELBASE_M = 10.0, 2.7
TIMES = 0.005 * np.arange(121)
BUMP = 0.05 * np.sin(np.pi * np.clip((GRID - 1.0) / 0.5, 0.0, 1.0))


def preview(height_m: np.ndarray, sigma_m: float, wheels: int = 2, position_m: float = 0.0) -> RoadPreview:
    rows = np.tile(height_m, (wheels, 1))
    return RoadPreview(
        0.6, GRID, rows, np.full_like(rows, position_m), np.full_like(rows, sigma_m), np.ones_like(rows)
    )


def driven(car: object, front_height: object, wheels: int = 2) -> WheelbasePreview:
    """Source after 6 m over a road; the rear wheels' road is still level."""
    source = WheelbasePreview(car)  # type: ignore[arg-type]
    for time in TIMES:
        heights = np.array([front_height(wheel, SPEED * float(time)) for wheel in range(wheels)])  # type: ignore[operator]
        source.update(replace(estimate(car, speed_m_s=SPEED), time_s=float(time), road_height=heights))  # type: ignore[arg-type]
    return source


def bump_at(place_m: float, x: float) -> float:
    return 0.05 * float(np.sin(np.pi * np.clip((x - place_m) / 0.5, 0.0, 1.0)))


def measured(wheel_of_bump: int = 0, wheels: int = 2, car: object = HALF) -> RoadPreview:
    """A bump of 5 cm, 1.0 to 1.5 m ahead of the rear wheel, that one front wheel has passed."""
    place = 6.0 - WHEELBASE_M + 1.0
    source = driven(car, lambda wheel, x: bump_at(place, x) if wheel == wheel_of_bump else 0.0, wheels)
    last = replace(estimate(car, speed_m_s=SPEED), time_s=float(TIMES[-1]))  # type: ignore[arg-type]
    return source.update(last)


def row(
    roads: np.ndarray, variance: np.ndarray, wheel: int = 1, seen: RoadPreview | None = None
) -> np.ndarray:
    felt, out = measured(), roads.copy()
    own = felt.height_m[wheel], felt.height_sigma_m[wheel], felt.existence[wheel]
    fuse(out, variance, (seen or preview(roads[0], 0.0)).distance_m, felt.distance_m, *own)
    return np.asarray(out[0])


def variance_of(seen: RoadPreview, early: np.ndarray, late: np.ndarray) -> np.ndarray:
    out = np.empty_like(early)
    previewed_variance(seen.height_m[0], seen.height_sigma_m[0], seen.existence[0], early, late, out)
    return out


def test_a_certain_preview_is_not_changed() -> None:
    heights = 0.5 * BUMP
    np.testing.assert_array_equal(row(heights[None], np.zeros_like(GRID)), heights)


def test_what_the_front_wheel_felt_replaces_an_uncertain_preview_as_far_as_the_front_axle() -> None:
    wrong = np.where(GRID > 2.0, 0.08, 0.0)
    result = row(wrong[None], np.full_like(GRID, 0.1**2))
    between = GRID < WHEELBASE_M - 0.05
    beyond = GRID > WHEELBASE_M + 0.05
    np.testing.assert_allclose(np.ptp(result[between] - BUMP[between]), 0.0, atol=2e-3)
    np.testing.assert_array_equal(result[beyond], wrong[beyond])


def test_measured_and_previewed_road_join_under_the_front_wheel() -> None:
    result = row(np.full((1, len(GRID)), 0.07), np.full_like(GRID, 0.1**2))
    assert np.abs(np.diff(result[np.abs(GRID - WHEELBASE_M) < 0.2])).max() < 1e-3


def test_each_point_is_weighted_by_inverse_variance() -> None:
    result = row(np.zeros((1, len(GRID))), np.full_like(GRID, 0.003**2))
    np.testing.assert_allclose(result, 0.5 * np.where(GRID < WHEELBASE_M, BUMP, 0.0), atol=1.5e-3)


def test_the_front_wheels_keep_their_preview() -> None:
    heights = BUMP[None]
    np.testing.assert_array_equal(row(heights, np.ones_like(GRID), wheel=0), heights[0])


def test_the_variance_holds_height_position_and_existence() -> None:
    seen = preview(np.full_like(GRID, 0.1), 0.01)
    same = seen.height_m[0]
    assert variance_of(seen, same, same) == pytest.approx(np.full_like(GRID, 1e-4))
    doubted = replace(seen, existence=np.full_like(seen.existence, 0.5))
    assert variance_of(doubted, same, same) == pytest.approx(np.full_like(GRID, 1e-4 + 0.25e-2))
    moved = variance_of(seen, same + 0.02, same)
    assert moved == pytest.approx(np.full_like(GRID, 1e-4 + 2e-4))
    assert variance_of(seen, same, same - 0.04) == pytest.approx(np.full_like(GRID, 1e-4 + 8e-4))


def test_in_the_full_car_each_side_follows_its_own_front_wheel() -> None:
    felt = measured(wheel_of_bump=1, wheels=4, car=FULL)
    seen = preview(np.zeros_like(GRID), 0.05, wheels=4)
    road = RoadReference(4, RoadSettings())
    now = replace(estimate(FULL, speed_m_s=SPEED), time_s=0.6)
    road.update(now, seen, felt)
    highest = road.heights(np.linspace(0.0, 0.2, 41)).max(axis=1)
    axle_x_m, right_m = np.array(FULL.axle_x_m), np.array(FULL.wheel_y_m)
    follower = (axle_x_m == axle_x_m.min()) & (right_m == right_m[1])
    assert highest[follower] > 0.045
    np.testing.assert_allclose(highest[~follower], 0.0, atol=1e-3)


@pytest.mark.parametrize("car", [HALF, FULL])
def test_without_preview_the_controller_is_that_with_wheelbase_preview(car: object) -> None:
    wheelbase, previewing = (
        PredictiveController(car, MpcSettings(), Timing(), source)  # type: ignore[arg-type]
        for source in ("wheelbase", "preview")
    )
    wheels = 2 if car is HALF else 4
    for time in TIMES[::2]:
        height = np.array([bump_at(2.0, SPEED * float(time))] * (wheels // 2) + [0.0] * (wheels // 2))
        now = replace(estimate(car, speed_m_s=SPEED), time_s=float(time), road_height=height)  # type: ignore[arg-type]
        np.testing.assert_array_equal(wheelbase.step(now, None), previewing.step(now, None))


def test_a_preview_of_nothing_known_does_as_well_for_the_rear_wheel_as_none() -> None:
    """Flat and known to 1 m everywhere: the rear wheel's road is the one measured."""
    felt, nothing = measured(), flat_preview(2, 0.6, GRID)
    unknown = replace(nothing, height_sigma_m=np.ones_like(nothing.height_m))
    now = replace(estimate(HALF, speed_m_s=SPEED), time_s=0.6)
    roads = []
    for arguments in ((unknown, felt), (exact(felt), None)):
        road = RoadReference(2, RoadSettings())
        road.update(now, *arguments)
        roads.append(road.heights(np.linspace(0.0, 0.2, 41)))
    np.testing.assert_allclose(*roads, atol=1e-4)
