from dataclasses import replace

import numpy as np
import pytest

from foreride.controller.interface import Estimate
from foreride.controller.road_ahead.wheelbase_preview import WheelbasePreview, leading_wheels
from foreride.files.errors import InputError
from foreride.vehicle.load import load_vehicle
from tests.controller.cars import estimate

HALF = load_vehicle("half")
WHEELBASE_M = 2.7
SPEED = 10.0
TIMES = 0.005 * np.arange(121)  # up to 6 m


def road(x: float) -> float:
    """Road with a bump of 5 cm between 5 and 5.5 m; the front axle starts at 0."""
    return 0.05 * float(np.sin(np.pi * np.clip((x - 5.0) / 0.5, 0.0, 1.0)))


def at(time_s: float, contact: bool = True) -> Estimate:
    front, rear = SPEED * time_s, SPEED * time_s - WHEELBASE_M
    now = estimate(HALF, speed_m_s=SPEED)
    heights = np.array([road(front), road(rear)])
    return replace(now, time_s=time_s, road_height=heights, contact=np.array([contact, True]))


def test_the_rear_sees_what_the_front_felt() -> None:
    source = WheelbasePreview(HALF)
    for time in TIMES:
        preview = source.update(at(float(time)))
    expected = [road(6.0 - WHEELBASE_M + d) for d in preview.distance_m]
    np.testing.assert_allclose(preview.height_m[1], expected, atol=1e-3)
    assert preview.height_m[1].max() > 0.049
    assert preview.distance_m[-1] == pytest.approx(WHEELBASE_M)


def test_the_front_sees_nothing() -> None:
    source = WheelbasePreview(HALF)
    for time in TIMES:
        preview = source.update(at(float(time)))
    assert not preview.height_m[0].any()
    assert not preview.existence[0].any()


def test_while_the_front_flies_the_road_is_bridged_and_under_its_tyre() -> None:
    """Off the ground from 5.1 to 5.4 m over the bump: straight line between the contacts, below the tyre."""
    source = WheelbasePreview(HALF)
    for time in TIMES:
        x = SPEED * float(time)
        flying = 5.1 <= x <= 5.4
        now = at(float(time), contact=not flying)
        if flying:
            now = replace(now, road_height=np.array([0.2, 0.0]))
        preview = source.update(now)
    line = np.interp(5.25, [5.05, 5.45], [road(5.05), road(5.45)])
    assert preview.height(1, WHEELBASE_M - 0.75) == pytest.approx(line, abs=5e-3)


def test_reset_forgets_the_road_behind() -> None:
    source = WheelbasePreview(HALF)
    for time in TIMES:
        source.update(at(float(time)))
    source.reset()
    assert not source.update(at(0.0)).height_m.any()


def test_one_axle_has_no_wheelbase() -> None:
    with pytest.raises(InputError, match="mpc_wheelbase must have a car with two axles"):
        WheelbasePreview(load_vehicle("quarter"))


def test_a_slow_car_measures_more_points_than_there_is_room_for_at_first() -> None:
    """A millimetre a sample: 2 700 of them between the axles."""
    source, climb = WheelbasePreview(HALF), 0.01
    for k in range(6500):
        now = replace(estimate(HALF, speed_m_s=0.2), time_s=0.005 * k)
        preview = source.update(replace(now, road_height=np.array([climb * 1e-3 * k, 0.0])))
        if k in (1500, 4200, 6499):
            places = np.clip(1e-3 * k - WHEELBASE_M + preview.distance_m, 0.0, None)
            np.testing.assert_allclose(preview.height_m[1], climb * places, atol=1e-9)


def test_heights_are_known_to_3_mm_and_to_30_where_the_wheel_was_in_the_air() -> None:
    source = WheelbasePreview(HALF)
    for time in TIMES:
        preview = source.update(at(float(time), contact=not 3.9 < SPEED * time < 4.6))
    places = 6.0 - WHEELBASE_M + preview.distance_m
    flown = (places > 3.96) & (places < 4.54)
    np.testing.assert_allclose(preview.height_sigma_m[1][flown], 0.03)
    np.testing.assert_allclose(preview.height_sigma_m[1][(places < 3.84) | (places > 4.66)], 0.003)
    np.testing.assert_allclose(np.diff(preview.distance_m), 0.025)
    assert preview.distance_m[0] == -0.5
    assert preview.existence[1].all()
    assert not preview.position_sigma_m.any()
    assert preview.time_s == TIMES[-1]


def test_wheels_follow_the_front_wheel_of_their_side() -> None:
    assert leading_wheels(load_vehicle("full")) == [0, 1, 0, 1]
    assert leading_wheels(HALF) == [0, 0]
    assert leading_wheels(load_vehicle("quarter")) == [0]
