import numpy as np
import pytest

from foreride.preview.obstacle_classes import BUMP
from foreride.preview.settings import Settings
from foreride.preview.tracking.gauss_newton import EdgeBearings, fit
from foreride.preview.tracking.mounting_filter import Gaussian
from foreride.preview.tracking.object_state import OFFSET, X
from foreride.preview.tracking.plane_residual import residual_variance_ratio
from foreride.preview.tracking.track import Edge, Track, first_fits

SETTINGS = Settings()
PRIOR = Gaussian(np.zeros(3), np.diag([np.deg2rad(0.25), 0.018, 1e-3]) ** 2)
OBJECT_M, PIXEL = 50.0, 1.0 / 457.0
CAMERA_M = np.arange(25.0, 45.9, 0.5)  # 10 m/s, 20 Hz, to where the front wheel is 2.5 m away


def approach(change_m, grade, rng, noise_px=1.0, correlated=0.0):
    """Edge bearings of a bump from a car on a road whose grade changes `change_m` before it."""
    height = lambda x: grade * np.maximum(x - (OBJECT_M - change_m), 0.0)  # noqa: E731
    front, rear = height(CAMERA_M + 1.6), height(CAMERA_M - 1.1)
    slope = (front - rear) / 2.7
    camera_z = rear + 1.1 * slope + 1.3
    crest = BUMP.height_m
    bottom = np.arctan2(camera_z - height(OBJECT_M), OBJECT_M - CAMERA_M) + np.arctan(slope)
    top = np.arctan2(camera_z - height(OBJECT_M) - crest, OBJECT_M + 0.22 - CAMERA_M) + np.arctan(slope)
    noise = noise_px * PIXEL * rng.normal(size=(2, len(CAMERA_M)))
    noise += correlated * PIXEL * rng.normal()
    sigma = np.hypot(PIXEL, np.deg2rad(SETTINGS.pitch_sigma_deg))
    rows = zip(CAMERA_M, bottom + noise[0], top + noise[1], strict=True)
    return [EdgeBearings(0.0, x, 1.3, b, t, sigma, sigma) for x, b, t in rows]


def track_of(bearings):
    track = Track(0, 0, 0.0, 0.0, Edge(-2, 0.1), Edge(2, 0.1), first_fits(0, OBJECT_M, 0.5, PRIOR), bearings)
    track.refit(PRIOR, SETTINGS)
    track.refit(PRIOR, SETTINGS)
    return track


@pytest.mark.parametrize("noise_px", [0.5, 1.0, 2.0])
def test_a_plane_road_does_not_strain_whatever_the_noise(noise_px):
    rng = np.random.default_rng(1)
    tracks = [track_of(approach(10.0, 0.0, rng, noise_px)) for _ in range(30)]
    assert np.mean([track.variance_ratio for track in tracks]) < 1.2
    assert np.mean([track.contradicts_plane for track in tracks]) <= 0.1


def test_neither_does_a_mounting_offset_or_a_box_that_is_always_too_large():
    rng = np.random.default_rng(2)
    bearings = approach(10.0, 0.0, rng, correlated=2.0)
    bearings = [sight._replace(bottom=sight.bottom + 0.003, top=sight.top + 0.003) for sight in bearings]
    assert not track_of(bearings).contradicts_plane


@pytest.mark.parametrize("change_m", [7.0, 10.0, 15.0])
@pytest.mark.parametrize("grade", [0.02, -0.02])
def test_a_change_of_grade_that_was_driven_over_is_flagged_and_widens_sigma(change_m, grade):
    rng = np.random.default_rng(3)
    tracks = [track_of(approach(change_m, grade, rng)) for _ in range(20)]
    error = np.array([track.start_m - OBJECT_M for track in tracks])
    assert np.abs(error).mean() > 0.15
    assert all(track.contradicts_plane for track in tracks)
    assert np.mean((error / [track.best.sigma_m for track in tracks]) ** 2) > 5
    assert np.mean((error / [track.sigma_m for track in tracks]) ** 2) < 2


def test_a_few_sights_tell_nothing():
    bearings = approach(10.0, 0.02, np.random.default_rng(0))
    assert residual_variance_ratio(bearings[:14], np.array([OBJECT_M, 0.0, 0.0, 0.45, 0.075, 0.0])) == 0.0
    assert residual_variance_ratio([], np.zeros(6)) == 0.0


def test_strain_is_the_variance_ratio_of_the_residuals():
    """Residuals +1, -1, +1, -1, ... sigma in blocks of mean m."""
    ahead = OBJECT_M - CAMERA_M[:30]
    model = np.arctan2(1.3, ahead)
    wave = np.tile([1.0, -1.0, 0.0, 1.0, -1.0], 6) + np.repeat([2.0, -2.0] * 3, 5)
    bearings = [
        EdgeBearings(0.0, x, 1.3, angle + 0.002 * r, np.nan, 0.002, 0.002)
        for x, angle, r in zip(CAMERA_M[:30], model, wave, strict=True)
    ]
    state = np.array([OBJECT_M, 0.0, 0.0, 0.45, 0.075, 0.0])
    assert state[OFFSET] == 0.0
    assert residual_variance_ratio(bearings, state) == pytest.approx(5 * 4.0 / 1.0)


def test_the_fit_itself_is_not_touched():
    bearings = approach(10.0, 0.0, np.random.default_rng(4))
    start = np.array([OBJECT_M, 0.0, 0.0, BUMP.length_m, BUMP.height_m, 0.0])
    assert fit(BUMP, bearings, start, PRIOR, [], SETTINGS).state[X] == pytest.approx(OBJECT_M, abs=0.15)


def test_three_blocks_of_five_are_enough():
    ahead, state = OBJECT_M - CAMERA_M[:15], np.array([OBJECT_M, 0.0, 0.0, 0.45, 0.075, 0.0])
    angles = np.arctan2(1.3, ahead) + 0.002 * np.repeat([2.0, -2.0, 2.0], 5)
    bearings = [
        EdgeBearings(0.0, x, 1.3, angle, np.nan, 0.002, 0.002)
        for x, angle in zip(CAMERA_M[:15], angles, strict=True)
    ]
    assert residual_variance_ratio(bearings, state) == pytest.approx(5 * 4.0)
