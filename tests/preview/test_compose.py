"""Composed preview of known tracks: height, position and uncertainty."""

from dataclasses import replace

import numpy as np
import pytest

from foreride.preview.compose import compose
from foreride.preview.road_preview import RoadPreview, distance_grid
from foreride.preview.settings import Settings
from foreride.preview.tracking.mounting_filter import Gaussian
from foreride.preview.tracking.object_state import HEIGHT, X
from foreride.preview.tracking.obstacle_templates import tyre_profile
from foreride.preview.tracking.track import Edge, Track, first_fits

SETTINGS, DISTANCE_M = Settings(), distance_grid()
AXLES_M, WHEELS_Y_M = (1.2, -1.4), (0.7, 0.7)
KNOWN = Gaussian(np.zeros(3), np.diag([1e-6, 1e-6, 1e-8]))


def track(start_m: float, height_m: float = 0.08, right_m: float = -2.0, confirmed: bool = True) -> Track:
    """A bump from `start_m` on, from `right_m` to 2 m on the left, seen when the odometer read 20 m."""
    fits = first_fits(0, start_m, 0.05, KNOWN)
    fits[0].state[HEIGHT] = height_m
    sides = Edge(right_m, 0.01**2), Edge(2.0, 0.01**2)
    return Track(0, 0, 0.0, 5.0, *sides, fits[:1], last_seen_x_m=20.0, confirmed=confirmed)


def composed(*tracks: Track) -> RoadPreview:
    return compose(tracks, 20.0, AXLES_M, WHEELS_Y_M, DISTANCE_M, SETTINGS, 1.0, 0.05)


def test_each_wheel_sees_the_bump_as_far_ahead_as_it_is() -> None:
    bump = track(24.0)
    preview = composed(bump)
    at, profile = tyre_profile(bump.best.kind, bump.section(0.7).length_m, 0.08)
    for wheel, axle in enumerate(AXLES_M):
        expected = np.interp(DISTANCE_M, 24.0 - 20.0 - axle + at, profile)
        np.testing.assert_allclose(preview.height_m[wheel], expected)
    met = preview.height_m != 0
    assert np.all(preview.existence[met] == bump.existence)
    assert np.all(preview.position_sigma_m[met] == pytest.approx(bump.sigma_m))
    assert np.all(preview.height_sigma_m[~met & (preview.existence == 0)] == SETTINGS.background_sigma_m)


def test_a_wheel_beside_the_object_meets_nothing_and_one_on_its_side_half_of_it() -> None:
    whole, beside, half = (composed(track(24.0, right_m=y)).height_m.max() for y in (-2.0, 0.9, 0.7))
    assert beside == 0.0
    assert half == pytest.approx(0.5 * whole, rel=1e-6)


def test_what_is_not_confirmed_or_lies_behind_is_left_out() -> None:
    assert not composed(track(24.0, confirmed=False)).height_m.any()
    assert not composed(track(12.0)).height_m.any()


@pytest.mark.parametrize("tracks", [(), (track(24.0, confirmed=False),), (track(24.0),)])
def test_what_a_preview_says_of_itself_is_what_its_arrays_say(tracks: tuple[Track, ...]) -> None:
    preview = composed(*tracks)
    rows = preview.height_m, preview.position_sigma_m, preview.height_sigma_m, preview.existence
    examined = RoadPreview(preview.time_s, preview.distance_m, *(row.copy() for row in rows), preview.age_s)
    assert preview.is_exact == examined.is_exact
    assert preview.is_empty == examined.is_empty == (not examined.height_m.any())
    np.testing.assert_array_equal(preview.height_here_m, examined.height_here_m)


def test_two_tracks_on_one_spot_count_once() -> None:
    low, high = track(24.0, 0.05), track(24.0, 0.09)
    alone = composed(high).height_m
    for tracks in ((low, high), (high, low)):
        np.testing.assert_allclose(composed(*tracks).height_m, alone)


def test_the_longer_unseen_the_less_is_known_of_the_place() -> None:
    bump = track(24.0)
    seen_long_ago = replace(bump, last_seen_x_m=10.0)
    near, far = (composed(t).position_sigma_m.max() for t in (bump, seen_long_ago))
    assert far == pytest.approx(np.hypot(bump.best.covariance[X, X] ** 0.5, 10.0 * SETTINGS.odometry_sigma))
    assert far > near


def test_an_object_exists_within_two_sigmas_of_its_place_before_each_axle() -> None:
    bump = track(24.0)
    covariance = bump.best.covariance.copy()
    covariance[X, X] = 0.3**2
    bump = replace(bump, fits=(bump.best._replace(covariance=covariance),))
    preview = composed(bump)
    for wheel, axle in enumerate(AXLES_M):
        past_edge = DISTANCE_M + 20.0 + axle - 24.0
        near = (past_edge > -0.6) & (past_edge < bump.section(0.7).length_m + 0.6)
        np.testing.assert_array_equal(preview.existence[wheel] > 0.0, near)
        np.testing.assert_allclose(preview.position_sigma_m[wheel], 0.3 * near, rtol=1e-9)
