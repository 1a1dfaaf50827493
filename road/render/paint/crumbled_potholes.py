"""Paint of crumbled potholes: broken edges, bare base course, loose gravel, mud and water."""

from dataclasses import dataclass

import numpy as np

from foreride.road.features.feature import Pothole
from foreride.road.render.appearance import Appearance
from foreride.road.render.map_tile import Block

_STYLES = ("broken", "base", "gravel", "mud")
_STYLE_SHARES = (0.36, 0.28, 0.18, 0.18)
_MUD = np.array((0.15, 0.10, 0.06), np.float32)
_SOIL = np.array((0.24, 0.14, 0.08), np.float32)
_DIRTY_WATER = np.array((0.13, 0.09, 0.06), np.float32)


@dataclass(frozen=True)
class PotholeCells:
    """Cells around one pothole.

    x (n, 1), y (1, m): cell centres, m. inside (n, m): footprint. lumps, stones (n, m): noise of lumps and
    of single stones.
    """

    x: np.ndarray
    y: np.ndarray
    inside: np.ndarray
    lumps: np.ndarray
    stones: np.ndarray


def paint(
    block: Block,
    part: tuple[slice, slice],
    hole: Pothole,
    ground: PotholeCells,
    rng: np.random.Generator,
    appearance: Appearance,
) -> None:
    """Paint one crumbled pothole into `part` of a block."""
    relative_depth = np.clip(-np.asarray(hole.height(ground.x, ground.y)) / hole.depth_m, 0, 1).astype(
        np.float32
    )
    style = str(rng.choice(_STYLES, p=_STYLE_SHARES))
    tint, roughness = _filling(style, appearance, rng)
    speckle = 1 + roughness * (0.7 * ground.lumps + 0.6 * ground.stones)
    filling = tint * np.clip(speckle, 0.25, 2.6)[..., None].astype(np.float32)
    albedo = block.albedo[part]
    coverage = (
        np.clip(relative_depth * rng.uniform(3, 12), 0, 1)
        if style != "base"
        else ground.inside.astype(np.float32)
    )
    edge_gain = 1 - rng.uniform(0.1, 0.6) * np.exp(-((relative_depth - 0.25) ** 2) / 0.03) * ground.inside
    painted = (albedo * (1 - coverage[..., None]) + filling * coverage[..., None]) * edge_gain[
        ..., None
    ].astype(np.float32)
    np.copyto(albedo, painted, where=ground.inside[..., None])
    _surround(albedo, hole, ground, tint, rng, appearance)
    wet_share = 0.25 + 0.35 * (appearance.weather in ("rain", "wet")) + 0.2 * (style == "mud")
    if rng.random() < wet_share:
        _fill_with_water(block, part, ground, relative_depth, rng)


def _filling(style: str, appearance: Appearance, rng: np.random.Generator) -> tuple[np.ndarray, float]:
    """Albedo (3,) of the filling of the hole, and its visible roughness."""
    road = np.float32(appearance.brightness)
    if style == "broken":
        return road * np.array((1.04, 1.0, 0.95), np.float32) * np.float32(rng.uniform(0.35, 0.8)), 0.5
    if style == "base":  # the lighter, sandy course under the asphalt
        warm = np.array((1.12, 1.0, 0.84), np.float32)
        return warm * np.float32(rng.uniform(0.9, 1.5) * max(1.25 * appearance.brightness, 0.17)), 0.3
    if style == "gravel":
        return np.array((1.05, 1.0, 0.92), np.float32) * np.float32(rng.uniform(0.12, 0.3)), 0.75
    return (_MUD, _SOIL)[rng.integers(2)] * np.float32(rng.uniform(0.6, 1.4)), 0.35


def _surround(
    albedo: np.ndarray,
    hole: Pothole,
    ground: PotholeCells,
    tint: np.ndarray,
    rng: np.random.Generator,
    appearance: Appearance,
) -> None:
    """Paint the ravelled fringe, dust of the filling carried out along the road, and loose stones."""
    u = (ground.x - hole.start_m - hole.length_m / 2) / (hole.length_m / 2)
    v = (ground.y - hole.y_m) / (hole.width_m / 2)
    rim_distance = np.hypot(u, v) - 1 + 0.35 * ground.lumps
    outside = ~ground.inside
    fringe = np.exp(-(np.maximum(rim_distance, 0) ** 2) / 0.04) * outside
    albedo *= (1 - rng.uniform(-0.1, 0.45) * fringe)[..., None].astype(np.float32)
    dust = np.clip(1.1 - np.hypot(0.65 * u, v) + 0.3 * ground.lumps, 0, 1) * outside
    share = (rng.uniform(0, 0.5) * appearance.decay * dust).astype(np.float32)[..., None]
    albedo += (tint * 1.15 - albedo) * share
    stone_density = np.clip(1.6 - 0.6 * np.maximum(rim_distance, 0), 0, 1) * outside
    loose_stones = outside & (ground.stones > 3.4 - (0.5 + 1.1 * appearance.decay) * stone_density)
    gain = np.float32(rng.uniform(0.4, 0.7) if rng.random() < 0.5 else rng.uniform(1.4, 2.0))
    np.copyto(albedo, np.clip(albedo * gain, 0.02, 0.5), where=loose_stones[..., None])


def _fill_with_water(
    block: Block,
    part: tuple[slice, slice],
    ground: PotholeCells,
    relative_depth: np.ndarray,
    rng: np.random.Generator,
) -> None:
    """Fill the hole with water to a level: brown and reflecting, with a dark damp margin above it."""
    level = rng.uniform(0.1, 0.8)
    height_over_level = level - relative_depth + 0.1 * ground.lumps
    damp = np.clip(1 - height_over_level / 0.5, 0, 1) * ground.inside
    block.albedo[part] *= (1 - 0.35 * damp)[..., None].astype(np.float32)
    water = (np.clip(-height_over_level / 0.08, 0, 1) * ground.inside).astype(np.float32)
    colour = _DIRTY_WATER * np.float32(rng.uniform(0.4, 1.5))
    block.albedo[part] += (colour - block.albedo[part]) * water[..., None]
    block.wet[part] = np.maximum(block.wet[part], water)
