"""Scene objects on or beside the road: polygon bodies, and sprites (upright pictures facing the camera)."""

from dataclasses import dataclass

import cv2
import numpy as np

Colour = tuple[float, float, float]


@dataclass(frozen=True)
class Face:
    """Plane polygon (n, 3) in the world (m), visible from the side to which its `normal` (3,) points.

    albedo: rgb; glow: emitted radiance, rgb (lamps).
    """

    points: np.ndarray
    normal: np.ndarray
    albedo: Colour
    glow: Colour = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Solid:
    """Polygon body: faces in painting order, base outline (n, 2) on the ground, height."""

    faces: tuple[Face, ...]
    base: np.ndarray
    height_m: float


@dataclass(frozen=True)
class Sprite:
    """Upright texture that faces the camera, the middle of its foot at x, y.

    levels: mip pyramid of the texture (h, w, 4), albedo rgb times coverage, and coverage (see `pyramid`).
    shadow: outlines (n, 2) of the parts that cast a shadow, in (metres to the left, metres up).
    glow: radiance of a lamp at the top, rgb.
    """

    x: float
    y: float
    width_m: float
    height_m: float
    levels: tuple[np.ndarray, ...]
    shadow: tuple[np.ndarray, ...] = ()
    glow: Colour = (0.0, 0.0, 0.0)


Prop = Solid | Sprite


def ground_position(prop: Prop) -> np.ndarray:
    """(2,) position on the ground, m."""
    return prop.base.mean(axis=0) if isinstance(prop, Solid) else np.array([prop.x, prop.y])


def pyramid(picture: np.ndarray) -> tuple[np.ndarray, ...]:
    """Mip pyramid of a texture (h, w, 4) of albedo rgb and coverage; each level has half the size."""
    picture = picture.copy()
    picture[..., :3] *= picture[..., 3:]
    levels = [picture]
    while min(levels[-1].shape[:2]) >= 4:
        levels.append(cv2.resize(levels[-1], None, fx=0.5, fy=0.5, interpolation=cv2.INTER_AREA))
    return tuple(levels)


def prism(
    low: tuple[float, float, float, float],
    high: tuple[float, float, float, float],
    z: tuple[float, float],
    albedo: Colour,
    glass: Colour | None = None,
) -> list[Face]:
    """Rear, front, right, left and top face of a frustum over rectangles (x0, x1, y0, y1) at two heights.

    glass: albedo of window panes in the four sides.
    """
    corners = [
        np.array([[r[0], r[2], h], [r[0], r[3], h], [r[1], r[3], h], [r[1], r[2], h]])
        for r, h in zip((low, high), z, strict=True)
    ]
    faces = []
    for a, b in ((0, 1), (2, 3), (3, 0), (1, 2)):
        side = np.array([corners[0][a], corners[0][b], corners[1][b], corners[1][a]])
        faces.append(_face(side, albedo))
        if glass is not None:
            middle = side.mean(axis=0)
            faces.append(_face(middle + (side - middle) * 0.84, glass))
    return [*faces, Face(corners[1], np.array([0.0, 0.0, 1.0]), albedo)]


def panel(
    x: float,
    y: tuple[float, float],
    z: tuple[float, float],
    facing: int,
    albedo: Colour,
    glow: Colour = (0, 0, 0),
) -> Face:
    """Upright rectangle across the road at x, facing ahead (+1) or back (-1): a lamp, a plate."""
    points = np.array([[x, y[0], z[0]], [x, y[1], z[0]], [x, y[1], z[1]], [x, y[0], z[1]]])
    return Face(points, np.array([float(facing), 0.0, 0.0]), albedo, glow)


def wheel(x: float, y: float, radius: float, side: int) -> list[Face]:
    """Tyre and rim as seen from the left (+1) or right (-1)."""
    angle = np.linspace(0, 2 * np.pi, 14, endpoint=False)
    faces = []
    for scale, albedo in ((1.0, (0.025, 0.025, 0.025)), (0.55, (0.25, 0.25, 0.26))):
        rim = np.stack(
            (
                x + scale * radius * np.cos(angle),
                np.full(14, y + 0.01 * side),
                radius + scale * radius * np.sin(angle),
            ),
            axis=1,
        )
        faces.append(Face(rim, np.array([0.0, float(side), 0.0]), albedo))
    return faces


def place_body(
    faces: list[Face], outline: np.ndarray, height_m: float, x: float, y: float, yaw: float
) -> Solid:
    """Place a body that is built around the origin on the road."""
    c, s = np.cos(yaw), np.sin(yaw)
    rotation = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1.0]])
    offset = np.array([x, y, 0.0])
    placed = tuple(Face(f.points @ rotation.T + offset, rotation @ f.normal, f.albedo, f.glow) for f in faces)
    return Solid(placed, outline @ rotation[:2, :2].T + offset[:2], height_m)


def _face(points: np.ndarray, albedo: Colour) -> Face:
    """Face with a normal that points away from the z axis."""
    normal = np.cross(points[1] - points[0], points[2] - points[0])
    normal = normal / max(float(np.linalg.norm(normal)), 1e-9)
    outward = points.mean(axis=0) * (1, 1, 0)
    return Face(points, normal if normal @ outward >= 0 else -normal, albedo)
