"""Replay of a recorded road surface: its point clouds through the elevation map, to previews.

The pose of the sensor over the road is taken from the plane of each cloud, as the sequence has no signals of
the suspension; the distance travelled and the path's curvature are those of the satellite receiver.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from foreride.files.errors import InputError
from foreride.preview.ego_motion.path import Path
from foreride.preview.elevation.fusion import ElevationFusion
from foreride.preview.road_preview import RoadPreview, distance_grid
from foreride.road.camera.pinhole import rotation_matrix
from foreride.road.tyre.tyre import Tyre
from foreride.scenarios.definition.schema import Scenario
from foreride.scenarios.recorded_surface.sequence import Frame, SurfaceSequence
from foreride.scenarios.recorded_surface.stereo import StereoHeights

Array = np.ndarray
_NEAR_M, _FAR_M, _BESIDE_M = 2.0, 12.0, 2.0
"""Points that determine the plane."""
_MIN_ON_PLANE = 50
_SPREAD_M = 0.02
"""Departure from the plane with half weight."""
_ITERATIONS = 8


class Step(NamedTuple):
    """Frame of a replay: time stamp, distance travelled, number of points, camera height, and preview."""

    stamp: str
    x_m: float
    points: int
    camera_height_m: float
    preview: RoadPreview


def replay_surface(
    sequence: SurfaceSequence, scenario: Scenario, from_images: bool = False
) -> Iterator[Step]:
    """Previews of the scenario's car, one per frame, from point clouds or stereo pairs. Raises InputError."""
    car, setup = scenario.vehicle.parameters, scenario.elevation
    mount = setup.sensor.mount(max(car.axle_x_m))
    fusion = ElevationFusion(
        setup.sensor,
        car.axle_x_m,
        car.wheel_y_m,
        setup.map,
        0.0,
        Tyre(car.wheel_radius_m, scenario.enveloping),
        distance_grid(ahead_m=scenario.preview_m),
    )
    stereo = StereoHeights(sequence, scenario.camera) if from_images else None
    for frame in sequence.frames:
        height_m, level = stereo.points(frame) if stereo else _of_cloud(sequence, frame)
        path = Path(frame.curvature_1_m, mount.x_m - min(car.axle_x_m))
        level[:, 1] = path.beside(level[:, 0], level[:, 1])
        position = np.array([frame.x_m + mount.x_m, 0.0, height_m])
        fusion.add(frame.time_s, level, (position, np.eye(3)), frame.x_m)
        preview = fusion.preview(frame.time_s, frame.x_m)
        yield Step(frame.stamp, frame.x_m, len(level), height_m, preview)


def _of_cloud(sequence: SurfaceSequence, frame: Frame) -> tuple[float, Array]:
    """Height of the sensor over the road, and points (n, 3) of a cloud in axes of the road."""
    points = sequence.points(frame)
    height_m, rotation = plane_pose(points, str(frame.cloud))
    return height_m, points @ rotation.T


def plane_pose(points: Array, source: str) -> tuple[float, Array]:
    """Height over the road, and rotation (3, 3) to axes of the road, of a sensor that sees points (n, 3).

    Robust plane through the points ahead, in axes of the sensor: forward, left, up.
    """
    near = (points[:, 0] > _NEAR_M) & (points[:, 0] < _FAR_M) & (np.abs(points[:, 1]) < _BESIDE_M)
    chosen = points[near]
    if len(chosen) < _MIN_ON_PLANE:
        raise InputError(
            f"{source}: must show the road {_NEAR_M:g} ... {_FAR_M:g} m ahead; only {len(chosen)} points lie "
            "there"
        )
    rows = np.column_stack([np.ones(len(chosen)), chosen[:, :2]])
    weight = np.ones(len(chosen))
    for _ in range(_ITERATIONS):
        weighted = rows * weight[:, None]
        plane = np.linalg.lstsq(weighted.T @ rows, weighted.T @ chosen[:, 2], rcond=None)[0]
        weight = 1.0 / (1.0 + ((chosen[:, 2] - rows @ plane) / _SPREAD_M) ** 2)
    level, forward, left = plane
    up = np.array([-forward, -left, 1.0]) / np.hypot(1.0, np.hypot(forward, left))
    pitch, roll = float(np.arcsin(-up[0])), float(np.arctan2(up[1], up[2]))
    return float(-level * up[2]), rotation_matrix(roll, pitch, 0.0)
