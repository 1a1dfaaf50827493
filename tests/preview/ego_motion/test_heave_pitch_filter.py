"""Heave and pitch filter: weights of single corrections against the variances they combine."""

import numpy as np
import pytest

from foreride.preview.ego_motion.heave_pitch_filter import HEAVE, PITCH, HeavePitchFilter
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
    assert body.covariance[PITCH, PITCH] == 0.0
    assert body.covariance[HEAVE, HEAVE] == pytest.approx(0.5 * SETTINGS.grade_rise_m**2, rel=0.01)


@pytest.mark.parametrize(("memory_s", "share"), [(1.0, 0.1), (0.1, 1.0), (0.02, 1.0)])
def test_roughness_is_the_running_mean_square_of_the_rise(memory_s: float, share: float) -> None:
    """Two heights 0.1 s apart that differ by 1 mm; with a memory shorter than that the last rise alone."""
    body = HeavePitchFilter(QUARTER_CAR, Settings(roughness_memory_s=memory_s))
    body.covariance[:], before = 0.0, body.roughness_m
    for road in (0.004, 0.005):
        body.level(np.array([-road]), 0.1)
    assert body.roughness_m**2 == pytest.approx((1.0 - share) * before**2 + share * 0.001**2)


def test_the_first_uncertainty_is_that_of_the_settings() -> None:
    """Vertical speed: ten times the heave per second, as bodies bounce at one to two hertz."""
    sigma = np.sqrt(np.diag(HeavePitchFilter(np.array([1.0, -1.4]), SETTINGS).covariance))
    np.testing.assert_allclose(sigma, [0.01, 0.1, *np.deg2rad([0.5, 0.1]), 0.03])


@pytest.mark.parametrize("axles", [np.array([1.1, -1.5]), QUARTER_CAR], ids=["two axles", "one axle"])
def test_a_prediction_integrates_readings_less_their_offsets(axles: np.ndarray) -> None:
    """Constant readings over one step, and the covariance of a first-order transition."""
    body, step = HeavePitchFilter(axles, SETTINGS), 0.02
    body.state[:] = 0.01, 0.2, 0.03, 0.004, 0.05
    root = np.random.default_rng(1).normal(size=(5, 5))
    body.covariance[:] = root @ root.T
    before, covariance = body.state.copy(), body.covariance.copy()
    body.predict(step, 1.5, 0.3)
    acceleration, rate = 1.5 - 0.05, 0.3 - 0.004 if len(axles) > 1 else 0.0
    moved = [0.2 * step + 0.5 * acceleration * step**2, acceleration * step, rate * step, 0.0, 0.0]
    np.testing.assert_allclose(body.state - before, moved)
    slope = np.zeros((5, 5))
    slope[0, 1], slope[1, 4], slope[2, 3] = 1.0, -1.0, -1.0
    transition = np.eye(5) + step * slope
    noise = np.diag([0.0, 0.003**2, np.deg2rad(0.01) ** 2, 0.0, 0.0]) * step
    np.testing.assert_allclose(body.covariance, transition @ covariance @ transition.T + noise)


def test_readings_over_both_axles_are_one_least_squares_problem() -> None:
    """Posterior of prior and heights over the axles, by information; pitch lowers what is ahead."""
    axles = np.array([1.1, -1.5])
    body = HeavePitchFilter(axles, SETTINGS)
    prior = np.diag(1.0 / np.diag(body.covariance))
    rows = np.array([[1.0, 0.0, -1.1, 0.0, 0.0], [1.0, 0.0, 1.5, 0.0, 0.0]])
    sigma, heights = 40.0 * 0.0005, np.array([0.012, -0.004])
    body.level(heights, 0.0)
    covariance = np.linalg.inv(prior + rows.T @ rows / sigma**2)
    np.testing.assert_allclose(body.covariance, covariance, rtol=1e-9, atol=1e-18)
    np.testing.assert_allclose(body.state, covariance @ rows.T @ heights / sigma**2, rtol=1e-9, atol=1e-15)
    np.testing.assert_allclose(body.road_m(heights), rows @ body.state - heights)


def test_a_rise_counts_as_at_most_two_and_a_half_usual_ones() -> None:
    body = HeavePitchFilter(QUARTER_CAR, Settings(roughness_memory_s=1.0))
    body.covariance[:], body.roughness_m = 0.0, 0.002
    for road in (0.0, 0.015):
        body.level(np.array([-road]), 0.1)
    assert body.roughness_m**2 == pytest.approx(0.9 * 0.002**2 + 0.1 * (2.5 * 0.002) ** 2)


def test_the_grade_ahead_is_uncertain_by_two_percent_while_the_plane_settles() -> None:
    """A change of grade at 10 m/s: 2 cm and 1 % at first, then three tenths of these every 50 ms."""
    body = HeavePitchFilter(np.array([1.1, -1.5]), SETTINGS)
    body.covariance[:] = 0.0
    assert body.grade_sigma == 0.0
    grown = []
    for _ in range(20):
        before = body.covariance.copy()
        turn = body.level(np.array([-0.08, -0.08]), 0.005, 10.0)
        if turn is not None:
            grown.append(body.covariance - before)
            assert body.grade_sigma > 0.0
    assert len(grown) == 2
    body = HeavePitchFilter(np.array([1.1, -1.5]), SETTINGS)
    body.covariance[:] = 0.0
    sigmas = []

    def recorded(deflection: np.ndarray, sigma_m: float) -> np.ndarray:
        sigmas.append((np.sqrt(np.diag(body.covariance)).tolist(), sigma_m))
        return body.road_m(deflection)

    body._correct = recorded  # type: ignore[method-assign]
    for _ in range(10):
        body.level(np.array([-0.08, -0.08]), 0.005, 10.0)
    added, sigma_m = sigmas[-2]
    np.testing.assert_allclose(added, [0.02, 0.1, 0.01, 0.0, 0.0])
    assert sigma_m == pytest.approx(4.0 * 0.0005)
    assert body.grade_sigma == pytest.approx(0.02)
    body.covariance[:] = 0.0
    for _ in range(10):
        body.level(np.zeros(2), 0.005, 10.0)
    np.testing.assert_allclose(sigmas[-2][0], np.multiply(0.3, [0.02, 0.1, 0.01, 0.0, 0.0]))
    assert body.grade_sigma == pytest.approx(0.02 * 0.95**2)
