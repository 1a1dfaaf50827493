import numpy as np
import pytest

from foreride.vehicle.speed_profile import ConstantSpeed, SpeedProfile


def test_braking_covers_the_distance_of_constant_deceleration() -> None:
    motion = SpeedProfile((0.0, 1.0, 3.0), (10.0, 10.0, 4.0), start_m=2.0)
    position, speed, acceleration = motion.at(np.array([0.5, 2.0, 3.0, 5.0]))
    np.testing.assert_allclose(position, [7.0, 2 + 10 + 10 - 1.5, 2 + 10 + 14, 2 + 24 + 8])
    np.testing.assert_allclose(speed, [10.0, 7.0, 4.0, 4.0])
    np.testing.assert_allclose(acceleration, [0.0, -3.0, 0.0, 0.0])


@pytest.mark.parametrize("place", [2.0, 11.0, 20.5, 26.0, 30.0])
def test_time_at_inverts_the_position(place: float) -> None:
    motion = SpeedProfile((0.0, 1.0, 3.0), (10.0, 10.0, 4.0), start_m=2.0)
    assert motion.at(motion.time_at(place))[0] == pytest.approx(place)


def test_stretches_do_not_depend_on_where_they_start() -> None:
    motion = SpeedProfile((0.0, 0.7), (10.0, 5.0))
    whole, tail = motion.ahead(0.0, 0, 1000), motion.ahead(-1.0, 400, 600)
    np.testing.assert_array_equal(whole.edges_m[400:], tail.edges_m)
    steady = ConstantSpeed(8.0).ahead(3.0, 0, 10)
    assert steady.edges_m[-1] == pytest.approx(3.08)
