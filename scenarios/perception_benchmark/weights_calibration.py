"""Calibration of a detector's weights: edge biases and score curves from drives whose true boxes are known.

Every box of a drive is an obstacle (it overlaps a true box of its class), a look-alike (it overlaps no true
box) or neither. The edge bias is the median error of the edges of obstacles at 4 to 15 m. The even score of a
box height lies halfway between the median scores of obstacles and of look-alikes.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from foreride.detector.calibration import Calibration, ClassCalibration
from foreride.detector.detections import CLASS_NAMES
from foreride.detector.nms import iou_matrix
from foreride.road.camera.pinhole import CameraPose, ground_point, pose_of
from foreride.road.render.outline_boxes import outline_boxes
from foreride.scenarios.definition.random_streams import random_stream
from foreride.scenarios.perceptions.camera import true_mount
from foreride.scenarios.perceptions.interface import Exposure
from foreride.scenarios.simulation.simulate import Run

OBSTACLE_IOU, LOOK_ALIKE_IOU = 0.3, 0.05
"""Least overlap with a true box of an obstacle, and greatest of a look-alike."""
MIN_BOXES = 20
"""Least number of boxes of each kind from which a bias or a score is taken."""
TRUE_RANGE_M = 45.0
EDGE_RANGE_M = (4.0, 15.0)


@dataclass(frozen=True)
class BoxSample:
    """Detected box of a drive: its class, score and height, and whether it is an obstacle.

    edge_error_px: of the top and bottom edge, rows counted downwards; None where it is not measured, as for
    look-alikes and beyond EDGE_RANGE_M.
    """

    cls: int
    score: float
    height_px: float
    is_obstacle: bool
    edge_error_px: tuple[float, float] | None = None


def box_samples(run: Run) -> Iterator[BoxSample]:
    """All boxes of a drive that are an obstacle or a look-alike."""
    mount = true_mount(run.case.scenario, random_stream(run.case.seed, "mounting"))
    for look in run.looks:
        at = {
            name: float(run.signals[name][look.tick]) for name in ("x_m", "heave_m", "pitch_rad", "roll_rad")
        }
        pose = pose_of(mount, at["x_m"], at["heave_m"], at["pitch_rad"], roll=at["roll_rad"])
        yield from _of_exposure(run, look, pose)


def _of_exposure(run: Run, look: Exposure, pose: CameraPose) -> Iterator[BoxSample]:
    scenario, found = run.case.scenario, look.detections
    camera = scenario.camera.intrinsics
    true_boxes, true_classes = outline_boxes(scenario.road, camera, pose, TRUE_RANGE_M)
    overlap = iou_matrix(found.boxes, true_boxes)
    for i, box in enumerate(found.boxes):
        sample = BoxSample(int(found.classes[i]), float(found.scores[i]), float(box[3] - box[1]), False)
        own_class = np.where(true_classes == sample.cls, overlap[i], 0.0)
        if own_class.max(initial=0.0) >= OBSTACLE_IOU:
            truth = true_boxes[own_class.argmax()]
            near = ground_point(camera, pose, [[(truth[0] + truth[2]) / 2, truth[3]]])[0, 0] - pose.x
            measured = EDGE_RANGE_M[0] <= near <= EDGE_RANGE_M[1] and truth[3] < camera.height_px - 1
            error = (float(box[1] - truth[1]), float(box[3] - truth[3])) if measured else None
            yield replace(sample, is_obstacle=True, edge_error_px=error)
        elif overlap[i].max(initial=0.0) <= LOOK_ALIKE_IOU:
            yield sample


def fit(samples: Sequence[BoxSample], previous: Calibration) -> Calibration:
    """Calibration of the weights that gave these boxes; `previous` where there are too few of a kind."""
    classes = range(len(CLASS_NAMES))
    return tuple(_fit_class([s for s in samples if s.cls == cls], previous[cls]) for cls in classes)


def _fit_class(samples: Sequence[BoxSample], previous: ClassCalibration) -> ClassCalibration:
    errors = np.array([s.edge_error_px for s in samples if s.edge_error_px is not None]).reshape(-1, 2)
    top, bottom = previous.top_bias_px, previous.bottom_bias_px
    if len(errors) >= MIN_BOXES:
        top, bottom = (round(float(value), 2) for value in np.median(errors, axis=0))
    return replace(
        previous, top_bias_px=top, bottom_bias_px=bottom, even_score=tuple(_even_scores(samples, previous))
    )


def _even_scores(samples: Sequence[BoxSample], previous: ClassCalibration) -> Iterator[float]:
    """Even score at each height of the curve, from the boxes nearest to it by ratio."""
    heights = np.log(previous.score_height_px)
    edges = np.exp((heights[:-1] + heights[1:]) / 2)
    for i, before in enumerate(previous.even_score):
        near = [s for s in samples if np.searchsorted(edges, s.height_px) == i]
        kinds = [[s.score for s in near if s.is_obstacle is kind] for kind in (True, False)]
        enough = min(map(len, kinds)) >= MIN_BOXES
        yield round(float(np.mean([np.median(scores) for scores in kinds])), 2) if enough else before
