import numpy as np
import pytest

from foreride.road.camera.pinhole import Camera, CameraPose
from foreride.road.features.feature import HalfSineBump, Pothole, WattsHump
from foreride.road.render.appearance import Appearance
from foreride.road.render.outline_boxes import Outlines, outline_boxes
from foreride.road.render.scene import Scene
from foreride.road.road import Road

CAMERA = Camera()
POSE = CameraPose(0.0, 0.0, 1.3, 0.0, np.deg2rad(6.0), 0.0)


def row(distance, z=0.0):
    return CAMERA.cy + CAMERA.focal_px * np.tan(np.arctan2(1.3 - z, distance) - POSE.pitch)


def test_a_regular_pothole_spans_its_near_and_far_rim():
    road = Road(40.0, (Pothole(10.0, 0.08, 0.8, 0.6, irregularity=0.0),))
    box = outline_boxes(road, CAMERA, POSE)[0][0]
    assert box[3] == pytest.approx(row(10.0), abs=0.1)
    assert box[1] == pytest.approx(row(10.8), abs=0.1)
    # Its sides touch the ellipse near its middle.
    half = 0.3 * CAMERA.focal_px / 10.4
    assert box[2] - box[0] == pytest.approx(2 * half, rel=0.04)


def test_a_bump_ends_at_its_silhouette():
    bump = HalfSineBump(10.0, 0.08, 0.4)
    box = outline_boxes(Road(40.0, (bump,)), CAMERA, POSE)[0][0]
    x = np.linspace(10.0, 10.4, 2001)
    assert box[3] == pytest.approx(row(10.0), abs=0.05)
    assert box[1] == pytest.approx(row(x, bump.height(x, 0.0)).min(), abs=0.05)


def test_range_bonnet_and_what_lies_behind():
    features = (HalfSineBump(2.0, 0.08, 0.4), HalfSineBump(12.0, 0.08, 0.4), HalfSineBump(32.0, 0.08, 0.4))
    road = Road(60.0, features)
    pose = CameraPose(8.0, 0.0, 1.3, 0.0, 0.1, 0.0)
    assert len(outline_boxes(road, CAMERA, pose, range_m=15.0)[0]) == 1
    assert len(outline_boxes(road, CAMERA, pose, range_m=30.0)[0]) == 2
    assert outline_boxes(road, CAMERA, pose, bonnet_row_px=250.0)[0][:, 3].max() <= 250.0


def test_views_on_the_way_show_what_each_alone_does():
    """Up to, over and beyond a hump, and back; outlines behind the car are not kept."""
    road = Road(60.0, (WattsHump(10.0), Pothole(25.0, 0.08, 0.6, 0.6, y_m=0.75)))
    outlines = Outlines(road)
    for x in (0.0, 9.0, 11.0, 12.0, 11.0, 5.0, 30.0):
        pose = CameraPose(x, 0.0, 1.3, 0.0, 0.1, 0.0)
        for kept, alone in zip(outlines.boxes(CAMERA, pose), outline_boxes(road, CAMERA, pose), strict=True):
            np.testing.assert_array_equal(kept, alone)
    assert not outlines._kept


def test_projection_and_renderer_draw_the_same_boxes():
    """Independent implementations: projected outlines, and ray hits counted on whole pixels."""
    features = (HalfSineBump(20.0, 0.08, 0.4), WattsHump(30.0), Pothole(25.0, 0.08, 0.6, 0.6, y_m=0.75))
    road = Road(60.0, features)
    scene = Scene(road, Appearance(), 0)
    for x in (14.0, 17.0, 20.0):
        pose = CameraPose(x, 0.0, 1.3, 0.0, np.deg2rad(6.0), 0.0)
        frame = scene.render(CAMERA, pose, 0)
        outlined = outline_boxes(road, CAMERA, pose, range_m=40.0)[0]
        for box in frame.boxes:
            nearest = outlined[np.argmin(np.abs(outlined[:, [1, 3]] - box[[1, 3]]).sum(axis=1))]
            np.testing.assert_allclose(nearest[[1, 3]], box[[1, 3]], atol=1.1)
            np.testing.assert_allclose(nearest[[0, 2]], box[[0, 2]], atol=4.0)
