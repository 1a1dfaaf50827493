"""Surface damage and stains (patches, cracks, manhole covers, oil), which are neither bump nor pothole."""

from dataclasses import dataclass

import cv2
import numpy as np

from foreride.road.render.appearance import Appearance
from foreride.road.render.map_tile import CELL_M, Block

MANHOLE_RADIUS_M = 0.32


@dataclass(frozen=True)
class Patch:
    """Asphalt repair.

    outline: corners (n, 2) in x, y, m. factor: albedo relative to the road. sealed: True for a sealed seam.
    """

    outline: np.ndarray
    factor: float
    sealed: bool


@dataclass(frozen=True)
class Crack:
    """Crack: a polyline (n, 2) in x, y with a width (m) and an albedo factor."""

    line: np.ndarray
    width_m: float
    factor: float


@dataclass(frozen=True)
class Damage:
    """Surface damage of a whole road."""

    patches: tuple[Patch, ...]
    cracks: tuple[Crack, ...]
    manholes: np.ndarray  # (n, 2)
    stains: tuple[tuple[float, float, float, float], ...]  # x, y, radius, factor


def plan(
    rng: np.random.Generator, appearance: Appearance, edges: tuple[float, float], length_m: float
) -> Damage:
    """Random damage of a whole road; densities are per 60 m."""
    share = length_m / 60

    def random_point() -> np.ndarray:
        return np.array([rng.uniform(0, length_m), rng.uniform(edges[0] + 0.3, edges[1] - 0.3)])

    patches = tuple(_patch(rng, random_point()) for _ in range(rng.poisson(9 * appearance.patches * share)))
    cracks = tuple(_crack(rng, random_point()) for _ in range(rng.poisson(45 * appearance.cracks * share)))
    manholes = np.array(
        [random_point() for _ in range(rng.poisson(2.5 * appearance.distractors * share))]
    ).reshape(-1, 2)
    stains = tuple(
        (*random_point(), rng.uniform(0.1, 0.6), rng.uniform(0.55, 0.9))
        for _ in range(rng.poisson(8 * appearance.distractors * share))
    )
    return Damage(patches, cracks, manholes, stains)


def paint(block: Block, damage: Damage) -> None:
    """Paint the damage into the block's albedo."""
    for patch in damage.patches:
        if block.reaches(patch.outline[:, 0].min(), patch.outline[:, 0].max(), 0.1):
            _paint_patch(block, patch)
    for x, y, radius, factor in damage.stains:
        if block.reaches(x - 4 * radius, x + 4 * radius):
            _paint_stain(block, x, y, radius, factor)
    gain = np.ones(block.height.shape, np.float32)
    for crack in damage.cracks:
        if block.reaches(crack.line[:, 0].min(), crack.line[:, 0].max(), 0.1):
            width = max(1, round(crack.width_m / CELL_M))
            cv2.polylines(gain, [block.corners(crack.line)], False, crack.factor, width, cv2.LINE_AA, 4)
    darkened = gain < 1
    block.albedo[darkened] *= gain[darkened][:, None]
    for centre in damage.manholes:
        if block.reaches(centre[0], centre[0], 0.5):
            _paint_manhole(block, centre)


def _patch(rng: np.random.Generator, centre: np.ndarray) -> Patch:
    length, width = rng.uniform(0.5, 6), rng.uniform(0.4, 2.4)
    corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * (length / 2, width / 2)
    if rng.random() < 0.35:  # a hand-laid patch has no straight edges
        angle = np.linspace(0, 2 * np.pi, 24, endpoint=False)
        radius = 0.5 * (1 + 0.12 * rng.standard_normal(24))
        corners = np.stack((np.cos(angle) * length, np.sin(angle) * width), axis=1) * radius[:, None]
    factor = rng.uniform(0.5, 0.85) if rng.random() < 0.65 else rng.uniform(1.1, 1.4)
    return Patch(centre + corners, float(factor), bool(rng.random() < 0.5))


def _crack(rng: np.random.Generator, start: np.ndarray) -> Crack:
    steps = int(rng.integers(8, 45))
    direction = rng.choice((0.0, np.pi / 2, rng.uniform(0, np.pi)), p=(0.45, 0.3, 0.25))
    headings = direction + 0.35 * rng.standard_normal(steps) + np.cumsum(0.08 * rng.standard_normal(steps))
    polyline = start + np.cumsum(0.12 * np.stack((np.cos(headings), np.sin(headings)), axis=1), axis=0)
    sealed = rng.random() < 0.2
    width = rng.uniform(0.05, 0.1) if sealed else rng.uniform(0.015, 0.045)
    return Crack(polyline, float(width), float(rng.uniform(0.3, 0.6) if sealed else rng.uniform(0.35, 0.75)))


def _paint_patch(block: Block, patch: Patch) -> None:
    rows = block.rows(patch.outline[:, 0].min() - 0.1, patch.outline[:, 0].max() + 0.1)
    cover = np.zeros(block.height[rows].shape, np.float32)
    points = block.corners(patch.outline) - np.array([0, rows.start * 16], np.int32)
    cv2.fillPoly(cover, [points], 1.0, cv2.LINE_AA, 4)
    block.albedo[rows] *= (1 + (patch.factor - 1) * cover)[..., None]
    if patch.sealed:
        seam = np.zeros_like(cover)
        cv2.polylines(seam, [points], True, 1.0, 3, cv2.LINE_AA, 4)
        block.albedo[rows] *= (1 - 0.55 * seam)[..., None]


def _paint_stain(block: Block, x: float, y: float, radius: float, factor: float) -> None:
    rows = block.rows(x - 4 * radius, x + 4 * radius)
    distance = np.hypot((block.x[rows] - x) / 1.6, block.y - y) / radius + 0.6 * block.noise["wear"][rows]
    block.albedo[rows] *= (1 - (1 - factor) * np.clip(1.3 - distance, 0, 1))[..., None].astype(np.float32)


def _paint_manhole(block: Block, centre: np.ndarray) -> None:
    rows = block.rows(centre[0] - 0.5, centre[0] + 0.5)
    radius = np.hypot(block.x[rows] - centre[0], block.y - centre[1])
    grid = (np.mod(block.x[rows], 0.09) < 0.035) ^ (np.mod(block.y, 0.09) < 0.035)
    iron = np.where(grid, 0.09, 0.14).astype(np.float32)[..., None] * np.ones(3, np.float32)
    frame = np.abs(radius - MANHOLE_RADIUS_M) < 0.025
    albedo = block.albedo[rows]
    albedo[radius < MANHOLE_RADIUS_M] = iron[radius < MANHOLE_RADIUS_M]
    albedo[frame] = 0.05
