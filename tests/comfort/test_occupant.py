import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from foreride.comfort import (
    SeatedPerson,
    acceleration_at,
    axis_values,
    body_motion,
    frequency_weighting,
    total_value,
)
from foreride.comfort.occupant import AXES
from foreride.files.errors import InputError

RATE = 1000.0
TIME = np.arange(20_000) / RATE
FREQ = 5.0
WAVE = np.sin(2 * np.pi * FREQ * TIME)
ZERO = np.zeros_like(WAVE)
DRIVER = SeatedPerson.at(0.3, 0.4, 0.1)


def rms(weighting):
    """Weighted RMS of WAVE in closed form."""
    return float(frequency_weighting(weighting, FREQ)) / np.sqrt(2)


def test_weightings_and_factors_of_the_twelve_axes():
    """ISO 2631-1:1997 8.2.2 as tabulated in phonometry's guide "Human vibration" (k comfort, seated)."""
    published = {
        "seat": [("Wd", 1.0), ("Wd", 1.0), ("Wk", 1.0), ("We", 0.63), ("We", 0.40), ("We", 0.20)],
        "backrest": [("Wc", 0.8), ("Wd", 0.5), ("Wd", 0.4)],
        "feet": [("Wk", 0.25), ("Wk", 0.25), ("Wk", 0.4)],
    }
    for point, expected in published.items():
        assert [(axis.weighting, axis.k) for axis in AXES.values() if axis.point == point] == expected


def test_pure_heave_shakes_all_points_alike_and_only_vertically():
    values = axis_values(RATE, DRIVER, *body_motion(WAVE))
    expected = {"seat_z": rms("Wk"), "backrest_z": 0.4 * rms("Wd"), "feet_z": 0.4 * rms("Wk")}
    for name, value in values.items():
        assert value == pytest.approx(expected.get(name, 0.0), rel=5e-3, abs=1e-12), name
    assert total_value(values) == pytest.approx(np.sqrt(sum(v**2 for v in expected.values())), rel=5e-3)


def test_nose_down_pitch_lowers_what_is_ahead_and_pushes_what_is_above_forward():
    acc = acceleration_at((2.0, 0.5, 1.0), *body_motion(ZERO, pitch_acc=WAVE))
    np.testing.assert_allclose(acc, [WAVE, ZERO, -2 * WAVE], atol=1e-15)


def test_roll_to_the_right_lifts_the_left_and_moves_what_is_above_to_the_right():
    acc = acceleration_at((2.0, 0.5, 1.0), *body_motion(ZERO, roll_acc=WAVE))
    np.testing.assert_allclose(acc, [ZERO, -WAVE, 0.5 * WAVE], atol=1e-15)


def test_pitch_about_the_seat_is_felt_as_rotation_at_the_back_and_at_the_feet():
    person = SeatedPerson(seat=(0, 0, 0), backrest=(0, 0, 0.35), feet=(0.8, 0, -0.27))
    values = axis_values(RATE, person, *body_motion(ZERO, pitch_acc=WAVE))
    expected = {
        "seat_pitch": 0.4 * rms("We"),
        "backrest_x": 0.8 * 0.35 * rms("Wc"),
        "feet_x": 0.25 * 0.27 * rms("Wk"),
        "feet_z": 0.4 * 0.8 * rms("Wk"),
    }
    for name, value in values.items():
        assert value == pytest.approx(expected.get(name, 0.0), rel=5e-3, abs=1e-12), name


@given(
    position=st.tuples(*[st.floats(-3, 3)] * 3),
    angular=st.tuples(*[st.floats(-5, 5)] * 3),
    step=st.floats(1e-4, 1e-3),
)
def test_transport_is_the_second_derivative_of_a_rigid_rotation(position, angular, step):
    """A body that starts to rotate from rest: path of a point by the exponential map, differentiated."""
    from scipy.spatial.transform import Rotation

    spin, arm = np.array(angular), np.array(position)
    moved = Rotation.from_rotvec(spin * step**2 / 2).apply(arm) - arm
    acc = acceleration_at(position, np.zeros((3, 1)), spin[:, None])[:, 0]
    np.testing.assert_allclose(2 * moved / step**2, acc, atol=1e-4)


def test_runs_are_a_leading_axis():
    rng = np.random.default_rng(0)
    acc, spin = rng.normal(size=(2, 4, 3, 900))
    together = axis_values(RATE, DRIVER, acc, spin)
    for run in range(4):
        alone = axis_values(RATE, DRIVER, acc[run], spin[run])
        for name in AXES:
            assert together[name][run] == pytest.approx(alone[name], rel=1e-12)
    assert total_value(together).shape == (4,)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: SeatedPerson((0, 0, 0), (0, 0), (0, 0, 0)), r"backrest must be three finite values"),
        (lambda: SeatedPerson.at(np.nan), "seat must be three finite values"),
        (lambda: axis_values(RATE, DRIVER, WAVE, WAVE), r"must both have shape \(..., 3, samples\)"),
        (lambda: axis_values(100.0, DRIVER, *body_motion(WAVE)), "rate must be >= 500 Hz"),
    ],
)
def test_bad_input_is_told_in_one_line(call, message):
    with pytest.raises(InputError, match=message):
        call()


def test_a_person_sits_upright_in_the_middle_with_back_behind_and_feet_ahead() -> None:
    person = SeatedPerson.at(0.1)
    assert person.seat == (0.1, 0.0, 0.0)
    assert person.backrest == pytest.approx((-0.1, 0.0, 0.35))
    assert person.feet == pytest.approx((0.9, 0.0, -0.27))
