import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from foreride.files.errors import InputError
from foreride.preview.ego_motion.ego_motion import EgoMotion
from foreride.preview.ego_motion.heave_pitch_filter import PlaneUpdate
from foreride.preview.settings import Settings
from foreride.preview.vehicle_facts import VehicleFacts
from foreride.road.vertical_alignment import GradeChange, grade_height
from tests.preview.kinematic_drive import Reading

AXLES = (1.25, -1.45)
STEP = 0.005


def still(speed=10.0, wheels=2):
    return Reading(np.zeros(wheels), np.zeros(wheels), np.zeros(wheels), 0.0, speed)


def oscillating(t, frequency_hz=1.4, pitch_amplitude=0.01, heave_amplitude=0.02):
    """Readings and truth (heave, pitch) of a body that oscillates over a flat road."""
    omega = 2 * np.pi * frequency_hz
    s, c = np.sin(omega * t), np.cos(omega * t)
    axle = np.array(AXLES)
    heave, pitch = heave_amplitude * s, pitch_amplitude * c
    body = heave - axle * pitch
    acceleration = -(omega**2) * body
    # The tyre carries both masses: -k wheel = m_u wheel'' + m_s acceleration, all of frequency omega.
    wheels = len(acceleration)
    compliance = VehicleFacts.typical(wheels).tyre_compliance
    sprung, unsprung = np.diag(compliance[:, :wheels]), np.diag(compliance[:, wheels:])
    wheel = -sprung * acceleration / (1 - omega**2 * unsprung)
    reading = Reading(acceleration, -(omega**2) * wheel, body - wheel, -omega * pitch_amplitude * s, 10.0)
    return reading, heave, pitch


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
    motion = run(lambda t: oscillating(t, frequency_hz)[0], 8.0)  # which starts in full swing
    for moment in (7.2, 7.5, 7.91):
        _, heave, pitch = oscillating(moment, frequency_hz)
        state = motion.at(moment)
        assert state.pitch_rad == pytest.approx(pitch, abs=0.0006)
        assert state.heave_m == pytest.approx(heave, abs=0.001)


def test_a_wheel_on_a_stone_does_not_turn_the_body():
    """At a strike the rattle space shows 5 cm of front travel, but the gyro no rotation."""

    def reading(t):
        struck = 2.0 <= t < 2.05
        wheel = np.array([300.0 if struck else 0.0, 0.0])
        return Reading(np.zeros(2), wheel, np.array([-0.05 if struck else 0.0, 0.0]), 0.0, 10.0)

    state = run(reading, 2.1).at(2.06)
    assert abs(state.pitch_rad) < 1e-12
    assert abs(state.heave_m) < 1e-12


def test_constant_offsets_of_the_sensors_are_learned():
    """A gyro offset of 0.1 deg/s would turn the body by 3 deg in 30 s, one of 0.03 m/s² lift it by 13 m."""
    offset = np.deg2rad(0.1)
    motion = run(lambda t: still()._replace(pitch_rate=offset, body_acc=np.full(2, 0.03)), 30.0)
    state = motion.at(29.9)
    assert abs(state.pitch_rad) < np.deg2rad(0.06)
    assert abs(state.heave_m) < 0.01


def test_the_frame_does_not_follow_roughness_under_the_wheels():
    """Wheels follow a wave of 8 m by 5 mm while the body floats level: the estimate must stay level.

    The rattle space alone would imply a body pitch of 2·5 mm·sin(pi·2.7/8)/2.7 m = 0.19 deg.
    """

    def reading(t):
        road = 0.005 * np.sin(2 * np.pi * (10.0 * t + np.array(AXLES)) / 8.0)
        wheel_acc = -((2 * np.pi * 10.0 / 8.0) ** 2) * road
        return still()._replace(rattle_m=-road, wheel_acc=wheel_acc)

    motion = run(reading, 6.0)
    states = [motion.at(t) for t in np.arange(4.5, 5.5, 0.05)]
    assert np.ptp([s.pitch_rad for s in states]) < np.deg2rad(0.03)
    assert np.ptp([s.heave_m for s in states]) < 0.002


def over_a_grade(t, to=0.02, at_m=20.0):
    """Readings of a car without springs at 10 m/s whose road begins to climb at `at_m`."""
    change = (GradeChange(at_m, to),)
    axle = np.array(AXLES)

    def road(moment):
        return grade_height(change, 10.0 * moment + axle)

    step = 1e-3
    before, now, after = road(t - step), road(t), road(t + step)
    acceleration = (after - 2 * now + before) / step**2
    pitch_rate = float(np.diff(after - before)[0] / (2 * step * (AXLES[0] - AXLES[1])))
    return still()._replace(body_acc=acceleration, wheel_acc=acceleration, pitch_rate=pitch_rate)


@pytest.mark.parametrize("to", [0.02, -0.02, 0.05])
def test_the_frame_follows_the_road_to_another_grade(to):
    """By the gyro the body has turned by 1.1 deg; relative to its road it has not. At 4 s it is 20 m on."""
    motion = run(lambda t: over_a_grade(t, to), 4.5)
    state = motion.at(4.0)
    assert abs(state.pitch_rad) < np.deg2rad(0.1)
    assert abs(state.heave_m) < 0.005


def test_while_the_grade_changes_the_road_ahead_is_uncertain():
    motion = EgoMotion(AXLES, Settings())
    sigma = {}
    for tick in range(round(4.5 / STEP)):
        motion.update(tick * STEP, over_a_grade(tick * STEP))
        sigma[tick] = motion.grade_sigma
    crossing = round((20.0 - AXLES[0]) / 10.0 / STEP)  # of the front wheels
    assert max(sigma[tick] for tick in range(crossing)) == 0.0
    assert max(sigma[tick] for tick in range(crossing, crossing + 80)) >= 0.02  # 4 m: what it does change by
    assert sigma[round(4.4 / STEP)] == 0.0


def test_a_frame_that_arrives_late_is_reckoned_from_the_turned_plane():
    """Between two plane updates the body moves smoothly: a step in the history would offset ranges."""
    motion = EgoMotion(AXLES, Settings())
    turns = 0
    for tick in range(round(3.0 / STEP)):
        motion.update(tick * STEP, over_a_grade(tick * STEP))
        if motion.turn is not None:
            turns += 1
            now = tick * STEP
            late = [motion.at(now - age) for age in (0.0, STEP, 0.1, 0.1 + STEP)]
            for newer, older in (late[:2], late[2:]):
                assert abs(newer.pitch_rad - older.pitch_rad) < 0.0005
                assert abs(newer.heave_m - older.heave_m) < 0.002
    assert turns > 3


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
    with pytest.raises(InputError, match="start of the history"):
        motion.at(1.0)
    with pytest.raises(InputError, match="no measurement"):
        EgoMotion(AXLES, Settings()).at(0.0)


def test_the_history_reaches_back_once_to_twice_its_set_length():
    """Steps of a power of two, so that no time is rounded."""
    step, motion = 1.0 / 64.0, EgoMotion(AXLES, Settings(history_s=0.25))
    for tick in range(80):
        now = tick * step
        motion.update(now, still())
        oldest = max(0.0, now - 0.25 + step)
        assert motion.at(oldest).x_m == pytest.approx(10.0 * oldest)
        with pytest.raises(InputError, match="start of the history"):
            motion.at(now - 0.5 - 1e-6)
        if now == 0.5:
            assert motion.at(0.0).x_m == 0.0


def test_a_turn_of_the_plane_changes_the_states_of_the_last_half_second_alone():
    """By its own heave, and by its pitch times what the car has travelled since."""
    motion = run(lambda t: oscillating(t)[0], 1.2)
    before = [motion.at(STEP * tick) for tick in range(240)]
    motion._transform_history(PlaneUpdate(0.01, 0.002))
    for tick, old in enumerate(before):
        new, turned = motion.at(STEP * tick), STEP * tick > STEP * 239 - 0.5 + 1e-9
        heave = 0.01 + (motion.x_m - old.x_m) * 0.002 if turned else 0.0
        assert new.heave_m == pytest.approx(old.heave_m + heave, abs=1e-12)
        assert new.pitch_rad == pytest.approx(old.pitch_rad + 0.002 * turned, abs=1e-12)
        assert (new.x_m, new.speed_m_s) == (old.x_m, old.speed_m_s)
