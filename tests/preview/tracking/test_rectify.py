import numpy as np
import pytest

from foreride.preview.estimator import Estimator
from foreride.preview.tracking.rectify import rectify_boxes
from foreride.road.camera.distortion import NO_DISTORTION
from foreride.road.camera.pinhole import Camera, CameraMount, CameraPose, pose_of, project
from foreride.road.features.feature import HalfSineBump, Pothole
from foreride.road.road import Road
from tests.preview.kinematic_drive import Reading, true_boxes, unbiased

BARREL = (-0.3, 0.1, 0.001, -0.0005, -0.01)
PINCUSHION = (0.1, -0.02, 0.0, 0.0, 0.0)
WHOLE = np.zeros((1, 4), bool)


def around(pixels):
    return np.concatenate([pixels.min(axis=0), pixels.max(axis=0)])[None]


@pytest.mark.parametrize("lens", [NO_DISTORTION, BARREL, PINCUSHION], ids=["none", "barrel", "pincushion"])
@pytest.mark.parametrize("roll", [-0.03, 0.0, 0.02])
def test_the_edges_of_a_bump_get_the_rows_of_a_level_ideal_camera(lens, roll):
    camera = Camera(distortion=lens)
    tilted, level = (CameraPose(0.0, 0.0, 1.3, angle, 0.0, 0.0) for angle in (roll, 0.0))
    y = np.linspace(-2.5, 1.5, 401)
    edges = [np.column_stack([np.full_like(y, x), y, np.zeros_like(y)]) for x in (6.0, 6.6)]
    box = around(np.concatenate([project(camera, tilted, edge) for edge in edges]))
    straight = rectify_boxes(camera, tilted, box, WHOLE, np.array([0]))[0]
    bottom, top = (project(camera.pinhole, level, edge)[0, 1] for edge in edges)
    assert (straight[3], straight[1]) == (pytest.approx(bottom, abs=0.2), pytest.approx(top, abs=0.2))
    if roll or lens != NO_DISTORTION:
        assert np.abs(box[0, [1, 3]] - (top, bottom)).max() > 0.5


@pytest.mark.parametrize("lens", [NO_DISTORTION, BARREL], ids=["none", "barrel"])
@pytest.mark.parametrize("roll", [-0.02, 0.0, 0.02])
def test_a_round_outline_gets_its_own_rows_too(lens, roll):
    camera = Camera(distortion=lens)
    tilted, level = (CameraPose(0.0, 0.0, 1.3, angle, 0.1, 0.0) for angle in (roll, 0.0))
    turn = np.linspace(0, 2 * np.pi, 721)
    rim = np.column_stack([8.0 + 0.4 * np.cos(turn), -1.2 + 0.3 * np.sin(turn), np.zeros_like(turn)])
    straight = rectify_boxes(camera, tilted, around(project(camera, tilted, rim)), WHOLE, np.array([1]))
    np.testing.assert_allclose(straight, around(project(camera.pinhole, level, rim)), atol=0.5)


def test_an_ideal_level_picture_stays_as_it_is():
    boxes = np.array([[100.0, 200.0, 300.0, 220.0]])
    pose = CameraPose(0.0, 0.0, 1.3, 0.0, 0.1, 0.0)
    assert rectify_boxes(Camera(), pose, boxes, WHOLE, np.array([0])) is boxes
    none = np.zeros((0, 4))
    assert rectify_boxes(Camera(distortion=BARREL), pose, none, none > 0, np.zeros(0, int)).shape == (0, 4)


@pytest.mark.parametrize("feature", [HalfSineBump(40.0, 0.08, 0.4), Pothole(40.0, 0.08, 0.6, 0.6, y_m=0.75)])
def test_a_known_lens_costs_nothing(feature):
    """Boxes through a known lens give the same edge as boxes of a distortion-free one."""
    edges = []
    for camera in (Camera(), Camera(distortion=BARREL)):
        estimator = Estimator(camera, CameraMount(), (0.0,), (0.75,), unbiased())
        for tick in range(700):
            estimator.update_motion(tick * 0.005, Reading(np.zeros(1), np.zeros(1), np.zeros(1), 0.0, 10.0))
            if tick % 10 == 0:
                pose = pose_of(CameraMount(), tick * 0.05, 0.0, 0.0)
                estimator.update_boxes(tick * 0.005, true_boxes(Road(60.0, (feature,)), camera, pose))
        (row,) = (row for row in estimator.stats() if row["confirmed"])
        edges.append(row["x_m"])
    assert edges[0] == pytest.approx(40.0, abs=0.03)
    assert edges[1] == pytest.approx(edges[0], abs=0.015)


@pytest.mark.parametrize("side", [0, 2])
@pytest.mark.parametrize("roll", [-0.04, 0.04])
def test_a_far_edge_that_the_border_cuts_is_as_wide_as_the_near_one(side, roll):
    """A bump that reaches out of the image on one side: with that side told as cut its top's row is exact."""
    camera, sign = Camera(), 1.0 if side == 0 else -1.0
    tilted, level = (CameraPose(0.0, 0.0, 1.3, angle, 0.0, 0.0) for angle in (roll, 0.0))
    y = sign * np.linspace(-1.0, 30.0, 20001)
    edges = [np.column_stack([np.full_like(y, x), y, np.zeros_like(y)]) for x in (6.0, 7.5)]
    pixels = np.concatenate([project(camera, tilted, edge) for edge in edges])
    box = around(pixels[(pixels[:, 0] >= 0.0) & (pixels[:, 0] <= camera.width_px)])
    errors = []
    for told in (side, 1):
        cut = np.zeros((1, 4), bool)
        cut[0, told] = True
        straight = rectify_boxes(camera, tilted, box, cut, np.array([0]))[0]
        errors.append(abs(straight[1] - project(camera.pinhole, level, edges[1])[0, 1]))
    assert errors[0] < 0.1
    if sign * roll < 0.0:
        assert errors[1] > 0.5
