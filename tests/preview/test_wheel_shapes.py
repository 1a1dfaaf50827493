"""Mixture of shapes in the preview: several kinds that the boxes cannot tell apart."""

import numpy as np
import pytest

from foreride.preview.obstacle_classes import HUMP, SINUSOIDAL, templates_of
from foreride.preview.tracking.mounting_filter import Gaussian
from foreride.preview.tracking.obstacle_templates import tyre_profile
from foreride.preview.tracking.track import Edge, Track, first_fits
from foreride.preview.wheel_shapes import mixture, wheel_shapes
from foreride.road.tyre.tyre import Tyre

KNOWN = Gaussian(np.zeros(3), np.diag([1e-6, 1e-6, 1e-8]))
X_M = np.arange(29.0, 35.0, 0.025)


def track(*kinds: object, costs: tuple[float, ...] = (1.0, 1.0)) -> Track:
    fits = [one for one in first_fits(0, 30.0, 0.05, KNOWN) if one.kind in kinds]
    fits = tuple(one._replace(cost=cost) for one, cost in zip(fits, costs, strict=False))
    return Track(0, 0, 0.0, 5.0, Edge(-2.0, 1e-4), Edge(2.0, 1e-4), fits, confirmed=True)


def mixed(track: Track) -> tuple[np.ndarray, np.ndarray]:
    """Height and its standard deviation under a wheel on the line y = 0.7 m; there is another one beside."""
    mean, sigma = np.empty((2, len(X_M)))
    mixture(1, X_M, *wheel_shapes(track, (-0.7, 0.7), Tyre())[1:], mean, sigma)
    return mean, sigma


def profile(kind: object) -> np.ndarray:
    at, height = tyre_profile(kind, kind.length_m, kind.height_m)  # type: ignore[attr-defined, arg-type]
    return np.interp(X_M - 30.0, at, height)


def test_equal_evidence_gives_the_mean_of_both_and_their_difference_as_doubt() -> None:
    mean, sigma = mixed(track(HUMP, SINUSOIDAL))
    np.testing.assert_allclose(mean, 0.5 * (profile(HUMP) + profile(SINUSOIDAL)), atol=1e-9)
    relative = HUMP.height_sigma_m / HUMP.height_m
    assert np.all(sigma >= relative * mean - 1e-9)
    apart = np.argmax(np.abs(profile(HUMP) - profile(SINUSOIDAL)))
    assert sigma[apart] > 1.05 * relative * mean[apart]


def test_a_new_fit_and_a_moved_edge_give_new_shapes() -> None:
    hump = track(HUMP)
    before = mixed(hump)[0]
    hump.fits = (hump.fits[0]._replace(state=1.02 * hump.fits[0].state),)
    after = mixed(hump)[0]
    assert np.abs(after - before).max() > 1e-3
    hole = Track(0, 1, 0.0, 5.0, Edge(-2.0, 1e-4), Edge(2.0, 1e-4), first_fits(1, 30.0, 0.05, KNOWN)[:1])
    before = mixed(hole)[0]
    hole.left.update(1.0, 1e-5)
    assert np.abs(mixed(hole)[0] - before).max() > 1e-4


def test_clear_evidence_leaves_one_kind() -> None:
    both = track(HUMP, SINUSOIDAL, costs=(1.0, 9.0))
    assert [one.kind for _, one in both.probable] == [HUMP]
    mean, sigma = mixed(both)
    np.testing.assert_allclose(mean, profile(HUMP), atol=1e-9)
    np.testing.assert_allclose(sigma, HUMP.height_sigma_m / HUMP.height_m * mean, atol=1e-6)


def test_probabilities_sum_to_one_and_are_those_of_the_shares_before_any_box() -> None:
    fresh = Track(0, 0, 0.0, 5.0, Edge(-2.0, 1e-4), Edge(2.0, 1e-4), first_fits(0, 30.0, 0.05, KNOWN))
    shares = {one.kind.name: share for share, one in fresh.probable}
    assert sum(shares.values()) == pytest.approx(1.0)
    assert shares == pytest.approx({kind.name: kind.share for kind in templates_of(0)})
