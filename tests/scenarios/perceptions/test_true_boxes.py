import numpy as np
import pytest

from foreride.detector.detections import Detections
from foreride.files.errors import InputError
from foreride.road.camera.pinhole import Camera, CameraPose
from foreride.road.features.feature import HalfSineBump, Pothole, WattsHump
from foreride.road.render.appearance import Appearance
from foreride.road.render.scene import Scene
from foreride.road.road import Road
from foreride.scenarios.definition.box_errors import BoxErrors
from foreride.scenarios.perceptions.true_boxes import degrade, true_boxes

CAMERA = Camera()
POSE = CameraPose(0.0, 0.0, 1.3, 0.0, np.deg2rad(6.0), 0.0)


def row(distance, z=0.0):
    return CAMERA.cy + CAMERA.focal_px * np.tan(np.arctan2(1.3 - z, distance) - POSE.pitch)


def test_a_regular_pothole_spans_its_near_and_far_rim():
    road = Road(40.0, (Pothole(10.0, 0.08, 0.8, 0.6, irregularity=0.0),))
    box = true_boxes(road, CAMERA, POSE).boxes[0]
    assert box[3] == pytest.approx(row(10.0), abs=0.1)
    assert box[1] == pytest.approx(row(10.8), abs=0.1)
    # Its sides touch the ellipse near its middle.
    half = 0.3 * CAMERA.focal_px / 10.4
    assert box[2] - box[0] == pytest.approx(2 * half, rel=0.04)


def test_a_bump_ends_at_its_silhouette():
    bump = HalfSineBump(10.0, 0.08, 0.4)
    box = true_boxes(Road(40.0, (bump,)), CAMERA, POSE).boxes[0]
    x = np.linspace(10.0, 10.4, 2001)
    assert box[3] == pytest.approx(row(10.0), abs=0.05)
    assert box[1] == pytest.approx(row(x, bump.height(x, 0.0)).min(), abs=0.05)


def test_range_bonnet_and_what_lies_behind():
    features = (HalfSineBump(2.0, 0.08, 0.4), HalfSineBump(12.0, 0.08, 0.4), HalfSineBump(32.0, 0.08, 0.4))
    road = Road(60.0, features)
    pose = CameraPose(8.0, 0.0, 1.3, 0.0, 0.1, 0.0)
    assert len(true_boxes(road, CAMERA, pose, range_m=15.0)) == 1
    assert len(true_boxes(road, CAMERA, pose, range_m=30.0)) == 2
    assert true_boxes(road, CAMERA, pose, bonnet_row_px=250.0).boxes[:, 3].max() <= 250.0


def many(errors, count=4000, seed=1):
    rng = np.random.default_rng(seed)
    found = Detections([[200.0, 220.0, 400.0, 260.0]], [1.0], [0])
    return [degrade(found, CAMERA, errors, rng) for _ in range(count)]


def test_noise_bias_and_misses_are_as_asked():
    seen = many(
        BoxErrors(pixel_sigma=1.5, bottom_bias_px=(2.0, 2.0), top_bias_px=(-1.0, -1.0), miss_probability=0.2)
    )
    boxes = np.concatenate([found.boxes for found in seen])
    assert 1 - len(boxes) / len(seen) == pytest.approx(0.2, abs=0.02)
    np.testing.assert_allclose(boxes.mean(axis=0), [200.0, 219.0, 400.0, 262.0], atol=0.15)
    np.testing.assert_allclose(boxes.std(axis=0), 1.5, rtol=0.05)


def test_false_boxes_come_at_their_rate():
    seen = many(BoxErrors(miss_probability=0.999, false_per_frame=0.3))
    assert np.mean([len(found) for found in seen]) == pytest.approx(0.3, abs=0.03)


def test_the_same_seed_gives_the_same_boxes():
    a, b = (many(BoxErrors(false_per_frame=0.5), 20, seed=7) for _ in range(2))
    for first, second in zip(a, b, strict=True):
        np.testing.assert_array_equal(first.boxes, second.boxes)


def test_edges_cut_by_the_image_stay_cut():
    rng = np.random.default_rng(0)
    found = Detections([[0.0, 300.0, 640.0, 384.0]], [1.0], [0])
    boxes = degrade(found, CAMERA, BoxErrors(miss_probability=0.0), rng).boxes
    np.testing.assert_array_equal(boxes[0, [0, 2, 3]], [0.0, 640.0, 384.0])


@pytest.mark.parametrize(
    ("field", "value"), [("pixel_sigma", -1.0), ("miss_probability", 1.0), ("range_m", 0.0)]
)
def test_refuses_impossible_errors(field, value):
    with pytest.raises(InputError, match=field):
        BoxErrors(**{field: value})


def test_projection_and_renderer_draw_the_same_boxes():
    """Independent implementations: projected outlines, and ray hits counted on whole pixels."""
    features = (HalfSineBump(20.0, 0.08, 0.4), WattsHump(30.0), Pothole(25.0, 0.08, 0.6, 0.6, y_m=0.75))
    road = Road(60.0, features)
    scene = Scene(road, Appearance(), 0)
    for x in (14.0, 17.0, 20.0):
        pose = CameraPose(x, 0.0, 1.3, 0.0, np.deg2rad(6.0), 0.0)
        frame = scene.render(CAMERA, pose, 0)
        outlined = true_boxes(road, CAMERA, pose, range_m=40.0).boxes
        for box in frame.boxes:
            nearest = outlined[np.argmin(np.abs(outlined[:, [1, 3]] - box[[1, 3]]).sum(axis=1))]
            np.testing.assert_allclose(nearest[[1, 3]], box[[1, 3]], atol=1.1)
            np.testing.assert_allclose(nearest[[0, 2]], box[[0, 2]], atol=4.0)
