"""Paint of worn potholes: lost top layers (delamination), and water up to the rim."""

import numpy as np

from foreride.road.features.feature import Pothole
from foreride.road.render.map_tile import Block
from foreride.road.render.paint.crumbled_potholes import PotholeCells

LAYER_DEPTH_M = 0.04
"""Greatest depth of a delamination: the thickness of a surface course."""
_MUDDY_WATER = np.array((0.22, 0.16, 0.10), np.float32)


def depth_share(hole: Pothole, ground: PotholeCells) -> np.ndarray:
    """Depth (n, m) below the road as a share of the hole's greatest."""
    return np.clip(-np.asarray(hole.height(ground.x, ground.y)) / hole.depth_m, 0, 1).astype(np.float32)


def delaminate(
    block: Block, part: tuple[slice, slice], hole: Pothole, ground: PotholeCells, rng: np.random.Generator
) -> None:
    """Bare the layer under a lost surface course: lighter or darker than the road, with a sharp edge."""
    factor = rng.uniform(0.5, 0.8) if rng.random() < 0.5 else rng.uniform(1.2, 1.7)
    texture = np.clip(1 + 0.12 * ground.lumps + 0.14 * ground.stones, 0.4, 1.8)
    share = depth_share(hole, ground)
    edge = 1 - rng.uniform(0.2, 0.55) * np.exp(-(((share - 0.3) / 0.25) ** 2))
    gain = (factor * texture * edge).astype(np.float32)[..., None]
    albedo = block.albedo[part]
    np.copyto(albedo, np.clip(albedo * gain, 0.02, 0.55), where=ground.inside[..., None])


def flood(
    block: Block, part: tuple[slice, slice], hole: Pothole, ground: PotholeCells, rng: np.random.Generator
) -> None:
    """Fill the hole nearly to its rim with muddy or clear water, whose level surface reflects the sky."""
    level, muddy = rng.uniform(0.05, 0.45), rng.random() < 0.55
    share = depth_share(hole, ground)
    damp = np.exp(-np.maximum(level - share, 0) / 0.3) * ground.inside * rng.uniform(0.2, 0.5)
    block.albedo[part] *= (1 - damp)[..., None].astype(np.float32)
    water = (np.clip((share - level) / 0.06 + 0.3 * ground.lumps, 0, 1) * ground.inside).astype(np.float32)
    below = block.albedo[part] * np.float32(rng.uniform(0.4, 0.8))  # seen through clear water
    colour = _MUDDY_WATER * np.float32(rng.uniform(0.5, 1.5)) if muddy else below
    block.albedo[part] += (colour - block.albedo[part]) * water[..., None]
    block.wet[part] = np.maximum(block.wet[part], water)
    block.height[part] += (np.maximum(share - level, 0) * hole.depth_m * ground.inside).astype(np.float32)
