"""Loose cover of the road: dust and soil, leaves and stones, puddles, snow."""

from dataclasses import dataclass

import cv2
import numpy as np

from foreride.road.render.appearance import Appearance
from foreride.road.render.map_tile import CELL_M, Block

_SOILS = {"red_soil": (0.26, 0.13, 0.07), "grass": (0.15, 0.13, 0.09), "dry_grass": (0.20, 0.16, 0.10)}
_DUST = (0.22, 0.18, 0.13)
_SNOW = np.array((0.80, 0.82, 0.86), np.float32)
_WATER = np.array((0.05, 0.05, 0.05), np.float32)
_LEAVES = ((0.30, 0.22, 0.08), (0.25, 0.14, 0.06), (0.14, 0.16, 0.05), (0.42, 0.40, 0.36), (0.10, 0.08, 0.06))
_MAX_LITTER_PER_M2 = 0.9  # highest density of litter


@dataclass(frozen=True)
class LooseCover:
    """Loose cover of a whole road.

    litter: (n, 6) x, y, radius (m), albedo rgb. puddles: (n, 3) x, y, radius (m). snow: amount in 0..1.
    """

    litter: np.ndarray
    puddles: np.ndarray
    snow: float


def plan(
    rng: np.random.Generator, appearance: Appearance, edges: tuple[float, float], length_m: float
) -> LooseCover:
    """Random loose cover of a whole road."""
    right, left = edges
    count = rng.poisson(_MAX_LITTER_PER_M2 * appearance.litter**2 * length_m * (left - right))
    kinds = rng.integers(len(_LEAVES), size=count)
    litter = np.column_stack(
        (
            rng.uniform(0, length_m, count),
            rng.uniform(right - 0.5, left + 0.5, count),
            rng.uniform(0.012, 0.05, count),
            np.array(_LEAVES)[kinds] * rng.uniform(0.6, 1.3, (count, 1)),
        )
    )
    pools = rng.poisson(14 * appearance.puddles * length_m / 60)
    puddles = np.column_stack(
        (rng.uniform(0, length_m, pools), rng.uniform(right, left, pools), rng.uniform(0.2, 1.3, pools))
    )
    return LooseCover(litter, puddles, float(rng.uniform(0.1, 1)) if appearance.weather == "snow" else 0.0)


def paint(block: Block, cover: LooseCover, appearance: Appearance, edges: tuple[float, float]) -> None:
    """Paint dust, litter, puddles and snow over a painted block."""
    if appearance.dirt:
        _dust(block, appearance, edges)
    for x, y, radius in cover.puddles:
        if block.reaches(x - 3 * radius, x + 3 * radius):
            rows = block.rows(x - 3 * radius, x + 3 * radius)
            distance = np.hypot((block.x[rows] - x) / 1.7, block.y - y) / radius
            water = np.clip((1 - distance - 0.5 * block.noise["dirt"][rows]) * 8, 0, 1).astype(np.float32)
            block.albedo[rows] += (_WATER - block.albedo[rows]) * 0.7 * water[..., None]
            block.wet[rows] = np.maximum(block.wet[rows], water)
    _litter(block, cover.litter)
    if cover.snow:
        _snow(block, cover.snow, edges)


def _dust(block: Block, appearance: Appearance, edges: tuple[float, float]) -> None:
    """Soil carried on from the verge: thick along the edges, thin in the middle, none in the wheel tracks."""
    soil = np.array(_SOILS.get(appearance.verge, _DUST), np.float32)
    edge_distance = np.minimum(block.y - edges[0], edges[1] - block.y)
    tracks = np.exp(-(((np.abs(block.y) - 0.8) / 0.35) ** 2))
    amount = (
        appearance.dirt * (0.15 + 0.85 * np.exp(-np.maximum(edge_distance, 0) / (0.3 + appearance.dirt)))
        - 0.12 * tracks
    )
    share = np.clip(amount * (1 + 0.9 * block.noise["dirt"] + 0.3 * block.noise["wear"]), 0, 0.85)
    block.albedo += (soil - block.albedo) * share.astype(np.float32)[..., None]


def _litter(block: Block, litter: np.ndarray) -> None:
    low, high = block.x[0, 0], block.x[-1, 0]
    for x, y, radius, *albedo in litter[(litter[:, 0] > low) & (litter[:, 0] < high)]:
        centre = (round((y - block.y[0, 0]) / CELL_M * 16), round((x - low) / CELL_M * 16))
        cv2.circle(block.albedo, centre, round(radius / CELL_M * 16), albedo, -1, cv2.LINE_8, 4)


def _snow(block: Block, amount: float, edges: tuple[float, float]) -> None:
    """Snow: deep beside the road, in patches and ridges on it, least in the wheel tracks."""
    inside = ((block.y > edges[0]) & (block.y < edges[1])).astype(np.float32)
    tracks = np.exp(-(((np.abs(block.y) - 0.8) / 0.4) ** 2))
    depth = 1.3 - inside * (2.0 - 1.5 * amount + 0.7 * tracks)
    coverage = depth + 0.7 * block.noise["dirt"] + 0.35 * block.noise["wear"]
    share = np.clip(1.8 * coverage, 0, 0.97).astype(np.float32)[..., None]
    block.albedo += (_SNOW * (1 + 0.5 * block.noise["tone"][..., None]) - block.albedo) * share
    block.wet *= 1 - share[..., 0]
