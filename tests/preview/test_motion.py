import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from files.errors import InputError
from preview.motion import EgoMotion
from preview.settings import Settings
from tests.preview.kinematic_drive import Reading

AXLES = (1.25, -1.45)
STEP = 0.005


def still(speed=10.0, wheels=2):
    return Reading(np.zeros(wheels), np.zeros(wheels), np.zeros(wheels), 0.0, speed)


def oscillating(t, frequency_hz=1.4, pitch_amplitude=0.01, heave_amplitude=0.02):
    """Readings and truth (heave, pitch) of a body that swings over a flat road."""
    omega = 2 * np.pi * frequency_hz
    s, c = np.sin(omega * t), np.cos(omega * t)
    axle = np.array(AXLES)
    heave, pitch = heave_amplitude * s, pitch_amplitude * c
    acceleration = -(omega**2) * (heave - axle * pitch)
    rattle = heave - axle * pitch
    return Reading(acceleration, np.zeros(2), rattle, -omega * pitch_amplitude * s, 10.0), heave, pitch


def run(reading_at, seconds):
    motion = EgoMotion(AXLES, Settings())
    for tick in range(round(seconds / STEP)):
        motion.update(tick * STEP, reading_at(tick * STEP))
    return motion


@given(st.floats(0.0, 1.0))
def test_constant_speed_is_interpolated_exactly(moment):
    motion = run(lambda t: still(), 1.0)
    assert motion.at(moment).x_m == pytest.approx(10.0 * moment, abs=1e-9)


def test_constant_braking_is_integrated_exactly():
    motion = run(lambda t: still(speed=15.0 - 3.0 * t), 2.0)
    t = 2.0 - STEP
    assert motion.at(t).x_m == pytest.approx(15.0 * t - 1.5 * t * t, abs=1e-9)


@pytest.mark.parametrize("frequency_hz", [0.8, 1.4, 3.0])
def test_pitch_and_heave_follow_the_body(frequency_hz):
    motion = run(lambda t: oscillating(t, frequency_hz)[0], 4.0)
    for moment in (3.2, 3.5, 3.91):
        _, heave, pitch = oscillating(moment, frequency_hz)
        state = motion.at(moment)
        assert state.pitch_rad == pytest.approx(pitch, abs=0.0006)
        assert state.heave_m == pytest.approx(heave, abs=0.001)


def test_a_wheel_on_a_stone_does_not_turn_the_body():
    """At a strike the rattle space says 5 cm of front travel, but the gyro says that nothing turned."""

    def reading(t):
        struck = 2.0 <= t < 2.05
        wheel = np.array([300.0 if struck else 0.0, 0.0])
        return Reading(np.zeros(2), wheel, np.array([-0.05 if struck else 0.0, 0.0]), 0.0, 10.0)

    state = run(reading, 2.1).at(2.06)
    assert abs(state.pitch_rad) < 1e-12
    assert abs(state.heave_m) < 1e-12


def test_gyro_bias_leaves_only_a_small_constant():
    """A first-order complementary filter turns a rate bias into bias times its time constant."""
    bias = np.deg2rad(0.1)
    motion = run(lambda t: still()._replace(pitch_rate=bias), 4.0)
    assert motion.at(3.9).pitch_rad == pytest.approx(bias * Settings().reference_time_s, rel=0.03)


def test_a_quarter_car_does_not_pitch():
    motion = EgoMotion((0.0,), Settings())
    for tick in range(100):
        motion.update(tick * STEP, still(wheels=1)._replace(pitch_rate=0.3))
    assert motion.at(0.4).pitch_rad == 0.0


def test_after_the_newest_measurement_the_car_rolls_on():
    motion = run(lambda t: still(), 1.0)
    assert motion.at(1.2).x_m == pytest.approx(12.0)


def test_refuses_time_that_stands_still_and_moments_long_gone():
    motion = run(lambda t: still(), 10.0)
    with pytest.raises(InputError, match="time_s must advance"):
        motion.update(5.0, still())
    with pytest.raises(InputError, match="oldest motion kept"):
        motion.at(1.0)
    with pytest.raises(InputError, match="no measurement"):
        EgoMotion(AXLES, Settings()).at(0.0)
