"""Heave and pitch filter: weights of single corrections against the variances they combine."""

import numpy as np
import pytest

from foreride.preview.ego_motion.heave_pitch_filter import HEAVE, HeavePitchFilter
from foreride.preview.settings import Settings

SETTINGS = Settings()
QUARTER_CAR = np.zeros(1)


def test_one_height_is_weighed_by_the_inverse_variances() -> None:
    """Prior of the body's heave against a road height that is as rough as the smoothest road."""
    body = HeavePitchFilter(QUARTER_CAR, SETTINGS)
    prior = SETTINGS.heave_sigma_m**-2
    reading = (SETTINGS.level_ratio * SETTINGS.least_roughness_m) ** -2
    body.level(np.array([0.01]), 0.0)
    assert body.state[HEAVE] == pytest.approx(0.01 * reading / (prior + reading))
    assert body.covariance[HEAVE, HEAVE] == pytest.approx(1.0 / (prior + reading))


def test_where_the_wheels_leave_the_plane_its_height_is_uncertain_by_two_centimetres() -> None:
    """The span's mean has a sigma of 4 rises, here also 2 cm: a body known exactly goes half the way.

    2 cm are also what the wheels have to rise at least for a change of grade to be detected.
    """
    body = HeavePitchFilter(QUARTER_CAR, SETTINGS)
    body.covariance[:], body.roughness_m = 0.0, SETTINGS.grade_rise_m / 4.0
    updates = [body.level(np.array([-0.05]), 0.005) for _ in range(10)]
    assert updates[:-1] == [None] * 9
    assert updates[-1] == (pytest.approx(-0.025), 0.0)
    assert body.covariance[HEAVE, HEAVE] == pytest.approx(0.5 * SETTINGS.grade_rise_m**2, rel=0.01)


@pytest.mark.parametrize(("memory_s", "share"), [(1.0, 0.1), (0.1, 1.0), (0.02, 1.0)])
def test_roughness_is_the_running_mean_square_of_the_rise(memory_s: float, share: float) -> None:
    """Two heights 0.1 s apart that differ by 1 mm; with a memory shorter than that the last rise alone."""
    body = HeavePitchFilter(QUARTER_CAR, Settings(roughness_memory_s=memory_s))
    body.covariance[:], before = 0.0, body.roughness_m
    for road in (0.0, 0.001):
        body.level(np.array([-road]), 0.1)
    assert body.roughness_m**2 == pytest.approx((1.0 - share) * before**2 + share * 0.001**2)
