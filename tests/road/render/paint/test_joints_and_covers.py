import numpy as np

from foreride.road.camera.pinhole import Camera, CameraMount, pose_of, project
from foreride.road.features.feature import (
    ExpansionJoint,
    ManholeCover,
    SinusoidalHump,
    SpeedCushion,
    Step,
    TrapezoidalBump,
)
from foreride.road.render.appearance import Appearance
from foreride.road.render.scene import Scene
from foreride.road.road import Road

CAMERA = Camera(width_px=320, height_px=192, focal_px=228.5)
POSE = pose_of(CameraMount(), 4.0, 0.0, 0.0)


def look(*features):
    return Scene(Road(30.0, features), Appearance(), seed=3).render(CAMERA, POSE)


def test_fittings_are_seen_and_are_neither_bump_nor_pothole():
    fittings = ManholeCover(8.0, diameter_m=1.0), ExpansionJoint(11.0, gap_m=0.3), Step(14.0, 0.08)
    plain_frame, fitted_frame = look(), look(*fittings)
    changed = np.abs(plain_frame.image.astype(int) - fitted_frame.image).max(axis=2) > 12
    for fitting in fittings:
        ends = np.array([[x, y, 0.0] for x in (fitting.start_m, fitting.end_m) for y in (-0.4, 0.4)])
        pixels = project(CAMERA, POSE, ends)
        left, top = np.floor(pixels.min(axis=0)).astype(int)
        right, bottom = np.ceil(pixels.max(axis=0)).astype(int)
        assert changed[top - 1 : bottom + 1, left:right].mean() > 0.3, fitting
    assert len(fitted_frame.boxes) == 0


def test_bumps_of_every_shape_have_boxes_beside_fittings():
    bumps = TrapezoidalBump(8.0), SpeedCushion(10.0), SinusoidalHump(14.0)
    frame = look(ManholeCover(7.0, y_m=0.9), *bumps)
    assert frame.classes.tolist() == [0, 0, 0]
    assert frame.feature_index.tolist() == [1, 2, 3]
    for box, bump in zip(frame.boxes, bumps, strict=True):
        near = project(CAMERA, POSE, np.array([[bump.start_m, y, 0.0] for y in (bump.y_max_m, bump.y_min_m)]))
        assert abs(box[3] - near[0, 1]) < 2
        assert abs(box[0] - max(near[0, 0], 0)) < 3
