"""Camera model: intrinsics, mounting on the sprung mass, projection and back-projection onto a plane.

Pixels (u, v) run right and down with edges at 0..width and 0..height, so pixel (column, row) has its centre
at (column + 0.5, row + 0.5). The camera looks along its own x axis; y is left, z up (ISO 8855), as for the
car.
"""

from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Annotated

import numpy as np
from annotated_types import Interval
from numpy.typing import ArrayLike, NDArray

from foreride.files.errors import InputError
from foreride.files.reading.checks import check_number
from foreride.files.reading.ranges import Checked
from foreride.road.camera.distortion import NO_DISTORTION, Distortion, distort, is_folded, undistort

Array = NDArray[np.float64]
Pixel = Annotated[float, Interval(ge=0.0, le=8192.0), "px"]
MOST_PIXELS = 20_000_000


@dataclass(frozen=True)
class Camera(Checked):
    """Intrinsics of a camera with square pixels.

    centre_px: principal point (u, v), None for the centre of the image; distortion: `road.camera.distortion`.
    Values out of range, or a distortion that folds the image, raise InputError.
    """

    width_px: Annotated[int, Interval(ge=16, le=8192), "px"] = 640
    height_px: Annotated[int, Interval(ge=16, le=8192), "px"] = 384
    focal_px: Annotated[float, Interval(ge=1.0, le=1e5), "px"] = 457.0
    centre_px: tuple[Pixel, Pixel] | None = None
    distortion: Distortion = NO_DISTORTION

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.width_px * self.height_px > MOST_PIXELS:
            resolution = f"{self.width_px} x {self.height_px}"
            raise InputError(f"width_px times height_px must be <= {MOST_PIXELS}, got {resolution}")
        if self.centre_px is not None:
            for value, size in zip(self.centre_px, (self.width_px, self.height_px), strict=True):
                check_number("centre_px", value, 0.0, size)
        if not self.is_pinhole and is_folded(self._normalised(self.border()), self.distortion):
            raise InputError(
                "distortion must map exactly one ray to each image point (no folding), got "
                f"{list(self.distortion)} with focal_px {self.focal_px:g}"
            )

    @property
    def cx(self) -> float:
        """Column of the principal point (px)."""
        return self.width_px / 2 if self.centre_px is None else self.centre_px[0]

    @property
    def cy(self) -> float:
        """Row of the principal point (px)."""
        return self.height_px / 2 if self.centre_px is None else self.centre_px[1]

    @property
    def is_pinhole(self) -> bool:
        """True for a lens without distortion."""
        return not any(self.distortion)

    @property
    def pinhole(self) -> "Camera":
        """The same camera with a distortion-free lens."""
        return self if self.is_pinhole else replace(self, distortion=NO_DISTORTION)

    def border(self, samples: int = 33) -> Array:
        """Pixels (4 samples, 2) along the image border."""
        columns, rows = np.linspace(0, self.width_px, samples), np.linspace(0, self.height_px, samples)
        sides = [(columns, 0 * rows), (columns, 0 * rows + self.height_px)]
        sides += [(0 * columns, rows), (0 * columns + self.width_px, rows)]
        return np.concatenate([np.column_stack(side) for side in sides])

    def undistort(self, pixels: ArrayLike) -> Array:
        """Undistorted pixels (N, 2): the positions of `pixels` behind a distortion-free lens."""
        pixels = np.asarray(pixels, float).reshape(-1, 2)
        if self.is_pinhole:
            return pixels
        return self.focal_px * undistort(self._normalised(pixels), self.distortion) + (self.cx, self.cy)

    def distort(self, pixels: ArrayLike) -> Array:
        """Distorted pixels (N, 2) of undistorted `pixels` (N, 2): inverse of `undistort`."""
        pixels = np.asarray(pixels, float).reshape(-1, 2)
        if self.is_pinhole:
            return pixels
        return self.focal_px * distort(self._normalised(pixels), self.distortion) + (self.cx, self.cy)

    def _normalised(self, pixels: Array) -> Array:
        return np.asarray((pixels - (self.cx, self.cy)) / self.focal_px)


@dataclass(frozen=True)
class CameraMount(Checked):
    """Camera mounting on the sprung mass.

    x_m, y_m: ahead and left of the centre of gravity; height_m: over the road with the car at rest;
    pitch_deg: nose-down tilt; cg_height_m: height over the road of the centre of gravity, about which the
    body rotates.
    """

    x_m: Annotated[float, Interval(ge=-10.0, le=10.0), "m"] = -0.35
    height_m: Annotated[float, Interval(ge=0.01, le=10.0), "m"] = 1.3
    pitch_deg: Annotated[float, Interval(ge=-80.0, le=80.0), "degrees"] = 6.0
    y_m: Annotated[float, Interval(ge=-5.0, le=5.0), "m"] = 0.0
    cg_height_m: Annotated[float, Interval(ge=0.0, le=5.0), "m"] = 0.55


@dataclass(frozen=True)
class CameraPose:
    """Camera pose: position (m, world) and attitude (rad).

    The attitude is yaw left, then pitch nose-down, then roll about the camera's axis.
    """

    x: float
    y: float
    z: float
    roll: float
    pitch: float
    yaw: float

    @property
    def position(self) -> Array:
        """(3,) position in the world, m."""
        return np.array([self.x, self.y, self.z])

    @property
    def rotation(self) -> Array:
        """(3, 3) rotation matrix from camera axes (forward, left, up) to world axes."""
        return rotation_matrix(self.roll, self.pitch, self.yaw)


def rotation_matrix(roll: float, pitch: float, yaw: float) -> Array:
    """(3, 3) rotation R_z(yaw) R_y(pitch) R_x(roll), body to world; pitch > 0 is nose-down (ISO 8855)."""
    angles = np.array([roll, pitch, yaw])
    (cr, cp, cw), (sr, sp, sw) = np.cos(angles).tolist(), np.sin(angles).tolist()
    return np.array(
        [
            [cw * cp, cw * sp * sr - sw * cr, cw * sp * cr + sw * sr],
            [sw * cp, sw * sp * sr + cw * cr, sw * sp * cr - cw * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )


@lru_cache(maxsize=8)
def _tilt(pitch_deg: float) -> Array:
    """(3, 3) rotation of a camera that is mounted with this pitch, read-only."""
    tilt = rotation_matrix(0.0, float(np.deg2rad(pitch_deg)), 0.0)
    tilt.setflags(write=False)
    return tilt


def pose_of(
    mount: CameraMount,
    x_cg: float,
    heave: float,
    pitch: float,
    *,
    y_cg: float = 0.0,
    roll: float = 0.0,
    yaw: float = 0.0,
) -> CameraPose:
    """World pose of a camera mounted on the sprung mass.

    Args:
        x_cg, y_cg: position of the centre of gravity (m, world).
        heave: displacement of the centre of gravity above rest (m). roll, pitch, yaw: body attitude (rad).
    """
    body = rotation_matrix(roll, pitch, yaw)
    offset = body @ np.array([mount.x_m, mount.y_m, mount.height_m - mount.cg_height_m])
    x, y, z = np.array([x_cg, y_cg, heave + mount.cg_height_m]) + offset
    attitude = body @ _tilt(mount.pitch_deg)
    return CameraPose(
        float(x),
        float(y),
        float(z),
        roll=float(np.arctan2(attitude[2, 1], attitude[2, 2])),
        pitch=float(np.arcsin(np.clip(-attitude[2, 0], -1.0, 1.0))),
        yaw=float(np.arctan2(attitude[1, 0], attitude[0, 0])),
    )


def project(camera: Camera, pose: CameraPose, points: ArrayLike) -> Array:
    """Perspective projection: pixels (N, 2) of world points (N, 3), not clipped to the image.

    Points that are not in front of the camera give nan.
    """
    forward, left, up = ((np.asarray(points, float).reshape(-1, 3) - pose.position) @ pose.rotation).T
    depth = np.where(forward > 1e-9, forward, np.nan)
    u = camera.cx - camera.focal_px * left / depth
    v = camera.cy - camera.focal_px * up / depth
    return camera.distort(np.stack([u, v], axis=1))


def rays(camera: Camera, pose: CameraPose, pixels: ArrayLike) -> Array:
    """Ray directions (N, 3) in the world through pixels (N, 2).

    They are scaled so that the component along the optical axis is 1.
    """
    u, v = camera.undistort(pixels).T
    left, up = (camera.cx - u) / camera.focal_px, (camera.cy - v) / camera.focal_px
    return np.stack([np.ones_like(u), left, up], axis=1) @ pose.rotation.T


def ground_point(camera: Camera, pose: CameraPose, pixels: ArrayLike, z: float = 0.0) -> Array:
    """Intersections (N, 3) of the rays through pixels (N, 2) with the plane of height z; nan without one."""
    direction = rays(camera, pose, pixels)
    with np.errstate(divide="ignore"):
        distance = (z - pose.z) / direction[:, 2]
    distance = np.where((distance > 0) & np.isfinite(distance), distance, np.nan)
    return pose.position + distance[:, None] * direction


def horizon_row(camera: Camera, pose: CameraPose, column: float | None = None) -> float:
    """Row v of the horizon of the plane z = const in an image column (cx by default).

    Lens distortion bends the horizon; the row returned is that behind a distortion-free lens.
    """
    u = camera.cx if column is None else column
    forward, left, up = pose.rotation[2]
    side = (camera.cx - u) / camera.focal_px
    return float(camera.cy + camera.focal_px * (forward + side * left) / up)
