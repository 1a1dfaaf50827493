"""Recorded sequence of a road surface in the layout of the RSRD data set: clouds, poses and calibration.

The Road Surface Reconstruction Dataset (Zhao et al., Scientific Data 11, 2024) has a folder per sequence:

    2023-04-08-02-33-11-1-conti/
        left/20230408023909.400.jpg    right/...    rectified stereo pair
        pcd/20230408023909.400.pcd     point cloud in axes of the LiDAR, m
        loc_pose_vel.pkl               list of {time, lon, lat (degrees), alt (mm), vel_e, vel_n, yaw, ...}
    calib_20230408.pkl                 K (3, 3) px, B mm, R (3, 3) and T (3, 1) m from LiDAR to left camera

The calibration is that of the date, in the folder or in one of the two above it. Axes of the camera are
right, down, forward; the yaw is in degrees, counterclockwise from north.
"""

import datetime
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from foreride.files.errors import InputError, shortened, shown
from foreride.files.reading.regular_file import read_bytes, reading
from foreride.road.io.readers import point_cloud
from foreride.scenarios.recorded_surface.pickled import read_pickle

Array = np.ndarray
POSES, CLOUDS, LEFT, RIGHT = "loc_pose_vel.pkl", "pcd", "left", "right"
_STAMP = "%Y%m%d%H%M%S.%f"
_EARTH_RADIUS_M = 6_371_000.0
_TO_SENSOR = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])
"""From right, down, forward to forward, left, up."""
CLOUD_LIMIT = 256 << 20
MIN_POINTS = 100


class Frame(NamedTuple):
    """Point cloud of a sequence: time (s), distance travelled (m), and curvature of the path (1/m)."""

    stamp: str
    time_s: float
    x_m: float
    curvature_1_m: float
    cloud: Path | None = None


class SurfaceSequence:
    """Frames of a sequence in order of time. Raises InputError for what is missing or damaged."""

    def __init__(self, folder: Path, stereo: bool = False) -> None:
        """Read poses and calibration; stereo: of the frames with images instead of point clouds."""
        self.folder = folder
        clouds = {path.stem: path for path in folder.glob(f"{CLOUDS}/*.pcd")}
        if not clouds and not stereo:
            raise InputError(f"{folder}: holds no point clouds {CLOUDS}/*.pcd of a recorded surface")
        images = {path.stem for path in folder.glob(f"{LEFT}/*.jpg")} if stereo else set(clouds)
        if not images:
            raise InputError(f"{folder}: holds no images {LEFT}/*.jpg of a recorded surface")
        poses = _poses(folder / POSES)
        stamps = sorted(images & set(poses))
        if len(stamps) < 2:
            raise InputError(
                f"{folder}: at least 2 frames must have a pose in {POSES}, got {len(stamps)} of {len(images)}"
            )
        self.without_pose = len(images) - len(stamps)
        times = np.array([_seconds(stamp, folder) for stamp in stamps])
        travelled, curvature = _path(np.array([poses[stamp] for stamp in stamps]))
        self.frames = [
            Frame(stamp, float(time_s - times[0]), float(x_m), float(bend), clouds.get(stamp))
            for stamp, time_s, x_m, bend in zip(stamps, times, travelled, curvature, strict=True)
        ]
        self.calibration_file, self.calibration = _calibration(folder, stamps[0][:8])
        if not stereo:
            self._rotation, self._translation = _extrinsics(self.calibration_file, self.calibration)

    def points(self, frame: Frame) -> Array:
        """Points (n, 3) of a frame in axes of the left camera's body: forward, left, up."""
        assert frame.cloud is not None
        with reading(frame.cloud):
            points = np.asarray(
                point_cloud.decode(frame.cloud, read_bytes(frame.cloud, CLOUD_LIMIT))["points"]
            )
            points = points.reshape(-1, 3).astype(float)
        points = points[np.isfinite(points).all(axis=1)]
        if len(points) < MIN_POINTS:
            raise InputError(f"{frame.cloud}: must hold at least {MIN_POINTS} points, got {len(points)}")
        return (points @ self._rotation.T + self._translation) @ _TO_SENSOR.T


def _poses(path: Path) -> dict[str, tuple[float, float, float]]:
    """Longitude, latitude and yaw (degrees) by time stamp."""
    rows = read_pickle(path)
    if not isinstance(rows, list) or not rows:
        raise InputError(f"{path}: must hold a list of poses, got {shown(type(rows).__name__)}")
    poses = {}
    for number, row in enumerate(rows):
        try:
            values = tuple(float(row[name]) for name in ("lon", "lat", "yaw"))
            stamp = str(row["time"])
        except (KeyError, TypeError, ValueError):
            raise InputError(
                f"{path}: pose {number} must have time, lon, lat and yaw, got {shortened(str(row), 80)}"
            ) from None
        if not (np.isfinite(values).all() and abs(values[1]) < 89.0):
            raise InputError(f"{path}: pose {number} must be a place on earth, got {shown(values)}")
        poses[stamp] = values
    return poses  # type: ignore[return-value]


def _seconds(stamp: str, folder: Path) -> float:
    try:
        at = datetime.datetime.strptime(stamp, _STAMP).replace(tzinfo=datetime.UTC)
    except ValueError:
        raise InputError(
            f"{folder}: names must be times such as 20230408023909.400, got {shown(stamp)}"
        ) from None
    return at.timestamp()


def _path(poses: Array) -> tuple[Array, Array]:
    """Distance travelled and curvature of the path, positive to the left, of poses (n, 3)."""
    lon, lat, yaw = np.radians(poses).T
    east, north = _EARTH_RADIUS_M * np.cos(lat[0]) * (lon - lon[0]), _EARTH_RADIUS_M * (lat - lat[0])
    steps = np.hypot(np.diff(east), np.diff(north))
    travelled = np.concatenate([[0.0], np.cumsum(steps)])
    turned = np.unwrap(yaw)
    moving = np.maximum(np.gradient(travelled), 0.05)
    return travelled, np.clip(np.gradient(turned) / moving, -0.2, 0.2)


def _calibration(folder: Path, date: str) -> tuple[Path, dict[str, Any]]:
    """Calibration of a date, and its file."""
    places = [folder, *list(folder.resolve().parents)[:2]]
    found = [path for place in places for path in sorted(place.glob(f"calib_{date}*.pkl"))]
    if not found:
        raise InputError(
            f"{folder}: needs the calibration calib_{date}.pkl in it or in one of the two folders above"
        )
    calibration = read_pickle(found[0])
    if not isinstance(calibration, dict):
        raise InputError(f"{found[0]}: must hold K, B, R and T, got {shown(type(calibration).__name__)}")
    return found[0], calibration


def _extrinsics(path: Path, calibration: dict[str, Any]) -> tuple[Array, Array]:
    """Rotation (3, 3) and translation (3,) from the LiDAR to the left camera."""
    try:
        rotation = np.asarray(calibration["R"], float).reshape(3, 3)
        translation = np.asarray(calibration["T"], float).reshape(3)
    except (KeyError, TypeError, ValueError):
        raise InputError(f"{path}: must hold R (3, 3) and T (3, 1), from the LiDAR to the camera") from None
    if not (np.abs(rotation @ rotation.T - np.eye(3)).max() < 1e-2 and np.abs(translation).max() < 20.0):
        raise InputError(f"{path}: R must be a rotation and T a place on the car, in m")
    return rotation, translation
