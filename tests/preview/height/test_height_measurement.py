"""Height measurement in rendered images, through the whole estimator."""

from collections.abc import Iterator

import numpy as np
import pytest

from foreride.detector.detections import Detections
from foreride.preview.estimator import Estimator
from foreride.preview.height import height_measurement
from foreride.preview.height.height_measurement import HeightGauge, _sigma_inflation
from foreride.preview.height.plane_parallax import ImageBand, StructureField, band, match
from foreride.preview.height.stereo import second_pose
from foreride.preview.settings import Settings
from foreride.preview.tracking.height_likelihood import HeightRows
from foreride.preview.tracking.mounting_filter import Gaussian
from foreride.preview.tracking.track import Edge, Track, first_fits
from foreride.road.camera.pinhole import Camera, CameraMount, pose_of
from foreride.road.features.feature import Feature, HalfSineBump, Pothole
from foreride.road.render.appearance import Appearance
from foreride.road.render.scene import Scene
from foreride.road.road import Road
from tests.preview.kinematic_drive import AXLES_M, WHEEL_Y_M, Reading, unbiased

CAMERA, MOUNT = Camera(), CameraMount()
BASE_M, SPEED_M_S, STEP_S, FRAME_STEPS = 0.2, 10.0, 0.005, 10
BUMP = HalfSineBump(30.0, 0.06, 0.5, paint="yellow_black")
HOLE = Pothole(30.0, 0.09, 0.7, 0.7, y_m=WHEEL_Y_M[0], seed=3)


def drive(feature: Feature, settings: Settings, base_m: float, mount: CameraMount = MOUNT) -> Estimator:
    """Smooth ride until the front wheel is 2 m before the feature; `mount` is the true mounting."""
    estimator = Estimator(CAMERA, MOUNT, AXLES_M, WHEEL_Y_M, settings, x_m=19.0, stereo_base_m=base_m)
    scene = Scene(Road(60.0, (feature,)), Appearance(light="noon", weather="dry", wear=0.3), 5)
    for step, x in enumerate(positions(feature)):
        estimator.update_motion(STEP_S * step, Reading(np.zeros(2), np.zeros(2), np.zeros(2), 0.0, SPEED_M_S))
        if step % FRAME_STEPS == 0:
            pose = pose_of(mount, x, 0.0, 0.0)
            frame = scene.render(CAMERA, pose, step)
            boxes = Detections(frame.boxes, np.ones(len(frame.boxes), np.float32), frame.classes)
            second = scene.render(CAMERA, second_pose(pose, BASE_M), 10_000 + step).image if base_m else None
            estimator.update_boxes(STEP_S * step, boxes, frame.image, second)
    return estimator


def positions(feature: Feature) -> Iterator[float]:
    x = 19.0
    while x + AXLES_M[0] < feature.start_m - 2.0:
        yield x
        x += SPEED_M_S * STEP_S


@pytest.mark.parametrize(("feature", "height", "share"), [(BUMP, 0.06, 0.15), (HOLE, -0.09, 0.25)])
def test_a_pair_measures_edge_and_height(feature: Feature, height: float, share: float) -> None:
    row = next(row for row in drive(feature, unbiased(), BASE_M).stats() if row["confirmed"])
    assert row["x_m"] == pytest.approx(feature.start_m, abs=0.06)
    assert row["height_m"] == pytest.approx(height, rel=share)


def test_a_pair_does_not_care_for_a_wrong_pitch() -> None:
    tilted = CameraMount(pitch_deg=MOUNT.pitch_deg + 0.4)
    mono, pair = (drive(BUMP, unbiased(), base, tilted).stats()[0] for base in (0.0, BASE_M))
    assert pair["x_m"] == pytest.approx(BUMP.start_m, abs=min(0.07, 3.0 * pair["sigma_m"]))
    assert pair["sigma_m"] < mono["sigma_m"]
    steady = drive(BUMP, unbiased(stereo_shift_sigma_m=0.02), BASE_M, tilted).stats()[0]
    assert steady["sigma_m"] < 0.5 * mono["sigma_m"]


def test_an_object_that_is_only_remembered_is_measured_without_a_box() -> None:
    track = drive(BUMP, unbiased(), BASE_M).tracker.tracks[0]
    track.bearings.clear()
    track.elevation = None
    pose = pose_of(MOUNT, 24.5, 0.0, 0.0)
    scene = Scene(Road(60.0, (BUMP,)), Appearance(light="noon", weather="dry", wear=0.3), 5)
    images = (scene.render(CAMERA, at, 0).image for at in (pose, second_pose(pose, BASE_M)))
    assert HeightGauge(CAMERA, BASE_M, unbiased()).measure(pose, *images, [track]) == [track]
    assert track.elevation is not None
    assert (len(track.elevation.frames), len(track.elevation.edges)) == (1, 0)


def test_heights_count_less_where_bare_road_does_not_look_flat() -> None:
    rng = np.random.default_rng(1)
    sigma, bare = np.full(4000, 0.01), np.arange(4000) < 3000
    flat = np.where(bare, rng.normal(0.0, 0.01, 4000), 0.08)
    still, moving = (HeightRows(flat, scale * flat, sigma, sigma, flat) for scale in (0.01, 5.0))
    assert _sigma_inflation(still, bare) == 1.0
    assert _sigma_inflation(moving, bare) == pytest.approx(2.0 * 5.0, rel=0.1)
    assert _sigma_inflation(moving, np.zeros(4000, bool)) == 1.0


def known(cls: int, start_m: float) -> Track:
    """Confirmed track, wide and in the middle of the road."""
    certain = Gaussian(np.zeros(3), np.zeros((3, 3)))
    track = Track(0, cls, 0.0, 0.0, Edge(-1.8, 0.01), Edge(1.8, 0.01), first_fits(cls, start_m, 0.1, certain))
    track.confirmed = True
    return track


@pytest.mark.parametrize(("cls", "window_m"), [(0, 0.6), (1, 0.2)])
def test_windows_and_strip_are_as_wide_as_they_appear(
    cls: int, window_m: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Windows at the object's middle; the strip of 3 m, about the camera's axis, where it is nearest."""
    seen: list[tuple[ImageBand, int]] = []

    def recorded(camera: Camera, view: ImageBand, *images: np.ndarray) -> StructureField:
        seen.append((view, int(images[-1])))
        return match(camera, view, *images)

    monkeypatch.setattr(height_measurement, "match", recorded)
    pose, track = pose_of(MOUNT, 24.0, 0.0, 0.0), known(cls, 29.5)
    image = np.random.default_rng(2).integers(0, 255, (CAMERA.height_px, CAMERA.width_px, 3), np.uint8)
    HeightGauge(CAMERA, BASE_M, unbiased()).measure(pose, image, image, [track])
    ((view, window_px),) = seen
    middle_m = 0.5 * (track.start_m + track.end_m) - pose.x
    assert window_px == pytest.approx(window_m * CAMERA.focal_px / middle_m, abs=2.0)
    first, last = view.left, view.left + view.ahead.shape[1] - 1
    assert first + last == CAMERA.width_px - 1
    assert (view.side[-1, 0], view.side[-1, -1]) == pytest.approx((1.5, -1.5), rel=0.05)


def test_a_row_counts_by_its_texture_however_weak() -> None:
    """Sigma is noise over the root of the squared gradients' sum: a tenth of the contrast, tenfold sigma."""
    pose, track = pose_of(MOUNT, 24.0, 0.0, 0.0), known(0, 29.5)
    view = band(CAMERA, pose, second_pose(pose, BASE_M), (220, 320), (270, 370))
    ones = np.ones_like(view.ahead)
    along = np.stack([-CAMERA.focal_px * BASE_M / view.ahead, 0.0 * ones])
    sigmas = []
    for contrast in (1e-5, 1e-3):
        field = StructureField(ones, contrast * ones, along, 1.0)
        found = HeightGauge(CAMERA, BASE_M, unbiased())._profile(pose, view, field, True, track, [track])
        assert found is not None
        assert len(found[0].x_m) == 50
        sigmas.append(found[0].sigma_m)
    np.testing.assert_allclose(sigmas[0], 10.0 * sigmas[1], rtol=0.01)


def test_without_images_nothing_is_measured() -> None:
    estimator = Estimator(CAMERA, MOUNT, AXLES_M, WHEEL_Y_M, unbiased(), stereo_base_m=BASE_M)
    estimator.update_motion(0.0, Reading(np.zeros(2), np.zeros(2), np.zeros(2), 0.0, SPEED_M_S))
    box = Detections(
        np.array([[100, 250, 500, 275]], np.float32), np.ones(1, np.float32), np.zeros(1, np.int64)
    )
    for _ in range(8):
        estimator.update_boxes(0.0, box)
    assert estimator.tracker.tracks[0].confirmed
    assert estimator.tracker.tracks[0].elevation is None


def test_images_are_seen_as_through_an_ideal_lens() -> None:
    bent = Camera(distortion=(-0.2, 0.05, 0.0, 0.0, 0.0))
    scene, pose = Scene(Road(60.0, (BUMP,)), Appearance(), 2), pose_of(MOUNT, 25.0, 0.0, 0.0)
    images = [scene.render(camera, pose, 0).image for camera in (CAMERA, bent)]
    ideal, crooked, straight = (
        HeightGauge(camera, 0.2, unbiased()).grey(image)[200:380, 60:580].astype(float)
        for camera, image in ((CAMERA, images[0]), (CAMERA, images[1]), (bent, images[1]))
    )
    assert np.abs(straight - ideal).mean() < 0.5 * np.abs(crooked - ideal).mean()
