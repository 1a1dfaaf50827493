"""Flat things that look like obstacles: their outlines lie where they are painted, their boxes where seen."""

import numpy as np
import pytest

from foreride.road.camera.pinhole import Camera, CameraMount, pose_of, project
from foreride.road.dataset.auxiliary_labels import RANGE_M, flat_boxes, has_labels
from foreride.road.obstacle_classes import AUXILIARY_NAMES
from foreride.road.render.appearance import Appearance
from foreride.road.render.paint.flat_objects import FlatObject
from foreride.road.render.scene import Scene
from foreride.road.road import Road

ROAD, CAMERA, POSE = Road(60.0), Camera(), pose_of(CameraMount(), 5.0, 0.0, 0.0)
PLAIN = Appearance(cracks=0, patches=0, distractors=0)


def square(x: float, y: float, half_m: float) -> np.ndarray:
    return np.array([x, y]) + half_m * np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])


def boxes_of(*outlines: np.ndarray, appearance: Appearance = PLAIN) -> np.ndarray:
    return flat_boxes([FlatObject("patch", o) for o in outlines], ROAD, appearance, CAMERA, POSE)[1]


def test_a_box_is_the_projected_outline() -> None:
    outline = square(13.0, 0.5, 0.6)
    (box,) = boxes_of(outline)
    corners = project(CAMERA, POSE, np.c_[outline, np.zeros(4)])
    assert box == pytest.approx([*corners.min(axis=0), *corners.max(axis=0)])


def test_what_is_out_of_sight_has_no_box() -> None:
    behind, far, aside = square(2.0, 0.0, 0.5), square(5.0 + RANGE_M + 2.0, 0.0, 0.5), square(8.0, 7.0, 0.5)
    assert len(boxes_of(behind, far, aside)) == 0
    (half,) = boxes_of(square(6.9, 0.0, 1.5))  # cut by the lower edge of the image
    assert half[3] == pytest.approx(CAMERA.height_px, abs=12)
    (above,) = boxes_of(square(8.5, 0.0, 1.5), appearance=Appearance(bonnet=0.2))
    assert above[3] <= 0.8 * CAMERA.height_px


@pytest.mark.parametrize(
    ("kind", "field"), [("patch", "patches"), ("crossing", "distractors"), ("arrow", "arrows")]
)
def test_objects_change_the_image_in_their_boxes(kind: str, field: str) -> None:
    """And nowhere else; each image is compared with that of the same road without them."""
    appearance = Appearance(cracks=0, patches=0, distractors=0, wear=0.0, edge_lines=False)
    for seed in range(20):
        scene = Scene(ROAD, Appearance(**vars(appearance) | {field: 1.0}), seed)
        classes, boxes = flat_boxes(scene.flat_objects(), ROAD, appearance, CAMERA, POSE)
        box = next(
            (b for c, b in zip(classes, boxes, strict=True) if AUXILIARY_NAMES[c] == kind and b[3] > 240),
            None,
        )
        if box is not None:
            break
    assert box is not None
    bare = Scene(ROAD, appearance, seed).render(CAMERA, POSE).image.astype(int)
    changed = np.abs(scene.render(CAMERA, POSE).image - bare).max(axis=2) > 12
    x0, y0, x1, y1 = box.round().astype(int)
    assert changed[y0:y1, x0:x1].mean() > 0.1
    for x0, y0, x1, y1 in boxes.round().astype(int):
        changed[max(y0 - 3, 0) : y1 + 3, max(x0 - 3, 0) : x1 + 3] = False
    assert changed[220:].mean() < 0.01


def test_snow_and_bent_lenses_have_no_labels() -> None:
    assert has_labels(PLAIN)
    assert not has_labels(Appearance(weather="snow"))
    assert not has_labels(Appearance(distortion=-0.05))
    assert Scene(ROAD, Appearance(weather="snow", patches=1.0), 0).flat_objects() == ()
    assert Scene(ROAD, Appearance(patches=1.0), 0).flat_objects()
