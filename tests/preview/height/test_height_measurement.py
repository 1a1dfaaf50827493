"""Height measurement in rendered images, through the whole estimator."""

from collections.abc import Iterator

import numpy as np
import pytest

from foreride.detector.detections import Detections
from foreride.preview.estimator import Estimator
from foreride.preview.height.height_measurement import HeightGauge, _sigma_inflation
from foreride.preview.height.stereo import second_pose
from foreride.preview.settings import Settings
from foreride.preview.tracking.height_likelihood import HeightRows
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
