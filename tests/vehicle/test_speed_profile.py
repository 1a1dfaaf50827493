import numpy as np
import pytest

from foreride.files.errors import InputError
from foreride.vehicle.speed_profile import ConstantSpeed, SpeedProfile, jerk_profile


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


def test_samples_are_at_the_edges_and_in_the_middle_of_the_ticks() -> None:
    steady = ConstantSpeed(8.0).ahead(3.0, 7, 4)
    np.testing.assert_allclose(steady.edges_m, 3.0 + 0.008 * np.arange(5))
    np.testing.assert_allclose(steady.middles_m, 3.004 + 0.008 * np.arange(4))
    np.testing.assert_array_equal(steady.speed_m_s, np.full(5, 8.0))
    assert steady.forward_acc is None
    braking = SpeedProfile((0.0, 2.0), (10.0, 4.0), start_m=1.0, start_tick=500).ahead(99.0, 1000, 3)
    time_s = 0.5 + 0.001 * np.arange(0.0, 3.25, 0.5)
    place = 1.0 + 10.0 * time_s - 1.5 * time_s**2
    np.testing.assert_allclose(braking.edges_m, place[::2])
    np.testing.assert_allclose(braking.middles_m, place[1::2])
    np.testing.assert_allclose(braking.speed_m_s, (10.0 - 3.0 * time_s)[::2])
    np.testing.assert_array_equal(braking.forward_acc, np.full(4, -3.0))


def test_a_profile_starts_at_zero_unless_told_otherwise() -> None:
    assert (SpeedProfile((0.0,), (5.0,)).start_m, SpeedProfile((0.0,), (5.0,)).start_tick) == (0.0, 0)
    assert SpeedProfile((0.0,), (5.0,)).at(2.0)[0] == pytest.approx(10.0)


def test_a_place_before_the_start_is_reached_before_it_and_one_beyond_a_stop_never() -> None:
    stopping = SpeedProfile((0.0, 2.0), (4.0, 0.0))
    assert stopping.time_at(3.0) == pytest.approx(1.0)
    assert stopping.time_at(4.1) == float("inf")
    assert SpeedProfile((0.0, 1.0), (4.0, 4.0)).time_at(-2.0) == pytest.approx(-0.5)


def test_the_speed_of_linear_accelerations_is_that_of_their_trapezoids_and_never_below_the_least() -> None:
    """1 to 3 m/s² over 0.5 s add 1 m/s; from 0.6 m/s a deceleration of 2 m/s² would end at rest."""
    rising = jerk_profile(5.0, np.array([1.0, 3.0, -1.0]), 0.5, 2.0, 300)
    assert rising.times_s == (0.0, 0.5, 1.0)
    np.testing.assert_allclose(rising.speeds_m_s, [5.0, 6.0, 6.5])
    assert (rising.start_m, rising.start_tick) == (2.0, 300)
    assert jerk_profile(0.6, np.array([-2.0, -2.0]), 0.5, 0.0, 0).speeds_m_s == (0.6, 0.5)


@pytest.mark.parametrize(
    ("times", "speeds", "told"),
    [
        ((), (), "times_s must start at 0"),
        ((0.0, 1.0), (1.0,), "times_s must start at 0 and have as many values"),
        ((0.5,), (1.0,), "times_s must start at 0"),
        ((0.0, 1.0, 1.0), (1.0, 1.0, 1.0), r"times_s must ascend, got \[0.0, 1.0, 1.0\]"),
    ],
)
def test_times_that_do_not_ascend_from_zero_are_refused(
    times: tuple[float, ...], speeds: tuple[float, ...], told: str
) -> None:
    with pytest.raises(InputError, match=told):
        SpeedProfile(times, speeds)
