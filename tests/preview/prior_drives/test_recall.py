"""Conversion of tracks to remembered objects and back, by hand."""

from dataclasses import replace

import numpy as np
import pytest

from foreride.preview.obstacle_classes import BUMP, POTHOLE, ObstacleTemplate
from foreride.preview.prior_drives.memory_file import Memory, Mounting, RememberedObject
from foreride.preview.prior_drives.recall import expectations, remember
from foreride.preview.settings import Settings
from foreride.preview.tracking.height_likelihood import HeightSamples
from foreride.preview.tracking.mounting_filter import Calibration
from foreride.preview.tracking.object_state import HEIGHT, LENGTH, X
from foreride.preview.tracking.track import Edge, Track, first_fits

SETTINGS = Settings()
CALIBRATION = Calibration(SETTINGS, 457.0)


def track(kind: ObstacleTemplate, length: tuple[float, float], height: tuple[float, float]) -> Track:
    """Confirmed track at 30 m with these posterior means and standard deviations."""
    (one,) = (fit for fit in first_fits(kind.cls, 30.0, 0.1, CALIBRATION.prior(kind.cls)) if fit.kind is kind)
    state, covariance = one.state.copy(), np.diag(np.full(len(one.state), 1e-4))
    state[[LENGTH, HEIGHT]] = length[0], height[0]
    covariance[X, X] = 0.05**2
    covariance[LENGTH, LENGTH], covariance[HEIGHT, HEIGHT] = length[1] ** 2, height[1] ** 2
    fit = one._replace(state=state, covariance=covariance)
    found = Track(3, kind.cls, 0.0, 2.0, Edge(-0.4, 0.01), Edge(0.7, 0.04), (fit,))
    found.confirmed = True
    return found


def remembered(one: Track) -> RememberedObject:
    (found,) = remember(CALIBRATION, [one]).objects
    return found


def test_a_size_is_remembered_without_its_prior() -> None:
    """Posterior information is the sum of prior and measurement, and its mean their weighted mean."""
    prior_mean, prior_sigma = BUMP.length_m, BUMP.length_sigma_m
    value, sigma = 0.7, 0.15
    total = prior_sigma**-2 + sigma**-2
    mean = (prior_mean * prior_sigma**-2 + value * sigma**-2) / total
    found = remembered(track(BUMP, (mean, total**-0.5), (0.08, 0.004)))
    assert (found.length_m, found.length_sigma_m) == (pytest.approx(value), pytest.approx(sigma))
    assert (found.kind, found.x_m, found.x_sigma_m) == ("bump", 30.0, pytest.approx(0.05))
    assert (found.y_min_m, found.y_max_m, found.y_sigma_m) == (-0.4, 0.7, pytest.approx(0.2))
    assert found.existence == pytest.approx(1.0 / (1.0 + np.exp(-2.0)))


@pytest.mark.parametrize(("share", "known"), [(0.06, True), (0.04, False)])
def test_a_twentieth_of_the_priors_information_counts_as_a_measurement(share: float, known: bool) -> None:
    posterior = BUMP.length_sigma_m / np.sqrt(1.0 + share)
    found = remembered(track(BUMP, (BUMP.length_m, posterior), (0.07, 0.004)))
    assert (found.length_m is not None) == known


def test_a_size_that_would_be_negative_is_none() -> None:
    low = remembered(track(BUMP, (0.1, BUMP.length_sigma_m / np.sqrt(1.2)), (0.07, 0.004)))
    assert (low.length_m, low.length_sigma_m) == (None, None)


def test_a_depth_is_remembered_if_it_was_measured_and_sides_in_their_order() -> None:
    hole = track(POTHOLE, (0.7, 0.05), (0.05, 0.005))
    assert (remembered(hole).height_m, remembered(hole).height_sigma_m) == (None, None)
    hole.elevation = HeightSamples(0.03, True)
    assert remembered(hole).height_m is not None
    crossed = remembered(replace(hole, right=Edge(0.5, 0.01), left=Edge(0.3, 0.01)))
    assert (crossed.y_min_m, crossed.y_max_m) == (0.5, 0.5)


def test_tracks_that_are_not_confirmed_are_forgotten() -> None:
    one = track(BUMP, (0.5, 0.05), (0.07, 0.004))
    one.confirmed = False
    assert remember(CALIBRATION, [one]).objects == ()


OBJECT = RememberedObject("bump", 40.0, 0.04, 0.6, 0.1, 0.08, 0.01, -0.5, 0.9, 0.15, 0.9)


def expected(*objects: RememberedObject, start_m: float = 10.0) -> list[Track]:
    return expectations(Memory(Mounting(), objects), CALIBRATION, SETTINGS, start_m, first=5)


def test_a_remembered_object_is_expected_with_the_drift_of_both_drives() -> None:
    """Root two of half a percent of the way to it, and the sigma that it was remembered with."""
    (found,) = expected(OBJECT)
    place, length, height = found.direct_measurements
    sigma = np.hypot(0.04, np.sqrt(2.0) * 0.005 * 30.0)
    assert (place.entry, place.value, place.sigma) == (X, 40.0, pytest.approx(sigma))
    assert (length.entry, length.value, length.sigma) == (LENGTH, 0.6, 0.1)
    assert (height.entry, height.value, height.sigma) == (HEIGHT, 0.08, 0.01)
    assert found.sigma_m == pytest.approx(sigma, rel=1e-6)
    fused = (0.6 / 0.1**2 + BUMP.length_m / BUMP.length_sigma_m**2) / (0.1**-2 + BUMP.length_sigma_m**-2)
    assert found.best.state[LENGTH] == pytest.approx(fused)


def test_existence_sides_and_class_are_those_remembered() -> None:
    found, unlikely = expected(OBJECT, replace(OBJECT, existence=0.3, length_m=None, length_sigma_m=None))
    assert found.existence == pytest.approx(0.9)
    assert (found.identity, unlikely.identity) == (5, 6)
    assert (found.right.y_m, found.left.y_m) == (-0.5, 0.9)
    assert (found.right.variance, found.left.variance) == (pytest.approx(0.15**2), pytest.approx(0.15**2))
    assert (found.confirmed, unlikely.confirmed) == (True, False)
    assert (found.hits, found.cls, found.born_s, found.last_seen_x_m) == (0, 0, 0.0, 40.0)
    assert found.class_log_odds == 7.0
    assert [measurement.entry for measurement in unlikely.direct_measurements] == [X, HEIGHT]
    assert unlikely.best.state[LENGTH] == pytest.approx(BUMP.length_m)


def test_a_mounting_is_the_nominal_one_unless_it_was_learned() -> None:
    assert not any(vars(Mounting()).values())
