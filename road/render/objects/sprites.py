"""Sprite textures of trees, poles, signs, people and riders: (h, w, 4) float32, albedo rgb and coverage."""

import cv2
import numpy as np

from foreride.road.render.noise import fractal
from foreride.road.render.objects.props import Colour

_SKIN = ((0.35, 0.22, 0.15), (0.20, 0.12, 0.08), (0.12, 0.07, 0.05))
_BARK = (0.10, 0.075, 0.055)


def tree(rng: np.random.Generator) -> np.ndarray:
    """Tree: a crown of leaves with gaps on a trunk, 160 x 128."""
    rows, cols = 160, 128
    picture = np.zeros((rows, cols, 4), np.float32)
    bole = int(rng.integers(3, 7))
    bark = tuple(np.array(_BARK) * rng.uniform(0.6, 1.6))
    for reach in rng.uniform(-0.6, 0.6, 4):
        fork = (64 + int(rng.integers(-2, 3)), 110)
        cv2.line(picture, fork, (int(64 + 60 * reach), 50), (*bark, 1.0), max(2, bole // 2))
    cv2.line(picture, (64, 159), (64, 70), (*bark, 1.0), bole)
    height = rng.uniform(0.55, 0.78)
    _crown(picture[: int(rows * height)], rng, rng.uniform(0.2, 0.7))
    return picture


def bush(rng: np.random.Generator) -> np.ndarray:
    """Bush, 48 x 96."""
    picture = np.zeros((48, 96, 4), np.float32)
    _crown(picture, rng, 0.9)
    picture[40:] = picture[39]
    return picture


def person(rng: np.random.Generator) -> np.ndarray:
    """Pedestrian, 96 x 40."""
    picture = np.zeros((96, 40, 4), np.float32)
    legs, shirt = _cloth(rng), _cloth(rng)
    stride = int(rng.integers(2, 9))
    for foot in (-stride, stride):
        cv2.line(picture, (20, 50), (20 + foot, 93), (*legs, 1.0), 7)
    if rng.random() < 0.3:  # a long skirt or a sari
        _polygon(picture, [(13, 46), (27, 46), (30, 92), (10, 92)], legs)
    _polygon(picture, [(11, 20), (29, 20), (27, 53), (13, 53)], shirt)
    for arm in (-1, 1):
        cv2.line(picture, (20 + 9 * arm, 22), (20 + int(11 + rng.integers(4)) * arm, 50), (*shirt, 1.0), 4)
    _head(picture, (20, 11), rng)
    return picture


def rider(rng: np.random.Generator) -> np.ndarray:
    """Bicycle or motorcycle with its rider, 96 x 48, from behind or in front."""
    picture = np.zeros((96, 48, 4), np.float32)
    cv2.line(picture, (24, 58), (24, 94), (0.02, 0.02, 0.02, 1.0), int(rng.integers(4, 9)))
    _polygon(picture, [(15, 52), (33, 52), (31, 72), (17, 72)], _cloth(rng))
    for leg in (-1, 1):
        cv2.line(picture, (24 + 5 * leg, 50), (24 + 10 * leg, 76), (*_cloth(rng), 1.0), 6)
    cv2.line(picture, (10, 44), (38, 44), (0.03, 0.03, 0.03, 1.0), 2)
    _polygon(picture, [(14, 20), (34, 20), (32, 54), (16, 54)], _cloth(rng))
    _head(picture, (24, 11), rng)
    return picture


def pole(rng: np.random.Generator, lamp: bool) -> np.ndarray:
    """Mast with cross-arms or with a lamp on an arm, 256 x 64."""
    picture = np.zeros((256, 64, 4), np.float32)
    grey = tuple(rng.uniform(0.12, 0.4) * np.array((1.0, 0.97, 0.92)))
    cv2.line(picture, (32, 255), (32, 4), (*grey, 1.0), 3)
    if lamp:
        arm = 4 if rng.random() < 0.5 else 60
        cv2.line(picture, (32, 8), (arm, 4), (*grey, 1.0), 2)
        cv2.line(picture, (arm, 4), (arm + (6 if arm < 32 else -6), 5), (*grey, 1.0), 4)
    else:
        for row in (10, 24)[: int(rng.integers(1, 3))]:
            cv2.line(picture, (10, row), (54, row), (*grey, 1.0), 3)
    return picture


def sign(rng: np.random.Generator) -> np.ndarray:
    """Round, triangular, square or board sign on its post, 128 x 48."""
    picture = np.zeros((128, 48, 4), np.float32)
    cv2.line(picture, (24, 127), (24, 20), (0.3, 0.3, 0.3, 1.0), 3)
    face, frame = (
        ((0.6, 0.6, 0.58), (0.45, 0.02, 0.02)) if rng.random() < 0.6 else ((0.55, 0.42, 0.03), (0.03,) * 3)
    )
    shape = int(rng.integers(3))
    for size, colour in ((21, frame), (15, face)):
        if shape == 0:
            cv2.circle(picture, (24, 24), size, (*colour, 1.0), -1)
        elif shape == 1:
            _polygon(picture, [(24, 24 - size), (24 + size, 24 + size), (24 - size, 24 + size)], colour)
        else:
            _polygon(picture, [(24, 24 - size), (24 + size, 24), (24, 24 + size), (24 - size, 24)], colour)
    cv2.line(picture, (24, 18), (24, 30), (0.03, 0.03, 0.03, 1.0), 4)
    return picture


def cone(rng: np.random.Generator) -> np.ndarray:
    """Traffic cone or painted bollard, 48 x 32."""
    picture = np.zeros((48, 32, 4), np.float32)
    low, high = (12, 3) if rng.random() < 0.6 else (6, 6)
    colour, band = (
        ((0.5, 0.12, 0.02), (0.6, 0.6, 0.6)) if low == 12 else ((0.5, 0.4, 0.04), (0.03, 0.03, 0.03))
    )
    _polygon(picture, [(16 - low, 47), (16 + low, 47), (16 + high, 2), (16 - high, 2)], colour)
    for row in (14, 28):
        picture[row : row + 6][picture[row : row + 6, :, 3] > 0] = (*band, 1.0)
    return picture


def _crown(part: np.ndarray, rng: np.random.Generator, fullness: float) -> None:
    """Leaves in an ellipse, lit from above, painted over the texture."""
    rows, cols, _ = part.shape
    v, u = np.mgrid[-1 : 1 : rows * 1j, -1 : 1 : cols * 1j]
    shape = fractal(rng, (rows, cols), (0.55, 0.5, 0.4, 0.35, 0.3))
    leafy = np.clip((1 - np.hypot(u, v) + 0.32 * shape + 0.12 * fullness) * 6, 0, 1)
    leafy *= np.clip(2.2 * fullness + 0.7 + 1.3 * fractal(rng, (rows, cols), (0.5, 0.5, 0.5)), 0, 1)
    green = np.array((0.055, 0.08, 0.025)) * rng.uniform(0.5, 1.5) * (rng.uniform(0.8, 1.7), 1, 1)
    light = np.clip(0.95 - 0.45 * v + 0.45 * fractal(rng, (rows, cols), (0.5, 0.5, 0.5, 0.4)), 0.25, 2.2)
    part[..., :3] += (green * light[..., None] - part[..., :3]) * leafy[..., None]
    part[..., 3] = np.maximum(part[..., 3], leafy)


def _cloth(rng: np.random.Generator) -> Colour:
    base = rng.uniform(0.03, 0.5)
    r, g, b = np.clip(base * rng.uniform(0.4, 1.5, 3), 0.02, 0.65)
    return float(r), float(g), float(b)


def _head(picture: np.ndarray, centre: tuple[int, int], rng: np.random.Generator) -> None:
    colour = _SKIN[int(rng.integers(3))] if rng.random() < 0.5 else (0.03, 0.025, 0.02)
    cv2.circle(picture, centre, 7, (*colour, 1.0), -1)


def _polygon(picture: np.ndarray, corners: list[tuple[int, int]], colour: Colour) -> None:
    cv2.fillPoly(picture, [np.array(corners, np.int32)], (*colour, 1.0))
