"""What bumps and potholes look like: paint, rubber, rubble, mud and water on their footprints."""

from typing import TYPE_CHECKING

import numpy as np

from road.appearance import Appearance
from road.features import Feature, Pothole
from road.texture import fractal

if TYPE_CHECKING:
    from road.surface import Block

_WHITE, _YELLOW = (0.62, 0.62, 0.60), (0.58, 0.40, 0.05)
_BLACK, _RED = (0.035, 0.035, 0.035), (0.24, 0.10, 0.07)
_FILLS = {"asphalt": (0.09, 0.085, 0.08), "rubble": (0.20, 0.18, 0.15), "mud": (0.19, 0.13, 0.08)}


def paint(block: "Block", feature: Feature, number: int, seed: int, look: Appearance) -> None:
    """Paint one feature into the block and enter its id (`number`); `seed` fixes all that is random in it."""
    margin = 0.5
    inside = (block.x[:, 0] > feature.start_m - margin) & (
        block.x[:, 0] < feature.start_m + feature.length_m + margin
    )
    across = (block.y[0] > feature.y_min_m - margin) & (block.y[0] < feature.y_max_m + margin)
    if not inside.any() or not across.any():
        return
    rows, cols = np.flatnonzero(inside), np.flatnonzero(across)
    part = (slice(rows[0], rows[-1] + 1), slice(cols[0], cols[-1] + 1))
    x, y = block.x[part[0]], block.y[:, part[1]]
    footprint = np.asarray(feature.footprint(x, y))
    block.ids[part][footprint] = number
    rng = np.random.default_rng(seed)
    if isinstance(feature, Pothole):
        _pothole(block, part, feature, footprint, rng)
    else:
        _bump(block, part, feature, footprint, rng, look)


def _bump(
    block: "Block",
    part: tuple[slice, slice],
    feature: Feature,
    footprint: np.ndarray,
    rng: np.random.Generator,
    look: Appearance,
) -> None:
    along = (block.x[part[0]] - feature.start_m) / feature.length_m
    across = block.y[:, part[1]] - feature.y_min_m
    base = np.float32(look.brightness * rng.uniform(0.7, 1.25)) * np.ones(3, np.float32)
    cover, colour, ground = _pattern(getattr(feature, "paint", "plain"), along, across, feature, base, rng)
    worn = np.clip(1.2 - 0.8 * look.wear + (0.2 + 0.7 * look.wear) * block.noise["wear"][part], 0.1, 1)
    share = (cover * worn)[..., None].astype(np.float32)
    tone = (1 + block.noise["tone"][part])[..., None]
    skin = (ground * (1 - share) + colour * share) * tone
    block.albedo[part] = np.where(footprint[..., None], skin, block.albedo[part])


def _pattern(
    paint_name: str,
    along: np.ndarray,
    across: np.ndarray,
    feature: Feature,
    base: np.ndarray,
    rng: np.random.Generator,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Cover (0..1) of the second colour, that colour, and the ground colour beneath, for a bump's paint."""
    along, across = np.broadcast_arrays(along, across)
    bar = rng.uniform(0.25, 0.55)
    slant = float(rng.choice((0.0, 0.5, -0.5)))
    flip = along > 0.5 if rng.random() < 0.3 else np.zeros_like(along, bool)
    bars = np.mod(np.floor(across / bar + slant * along), 2) == 0
    white, yellow = np.array(_WHITE, np.float32), np.array(_YELLOW, np.float32)
    if paint_name == "yellow_black":
        seam = np.mod(across, bar) < 0.02
        black = np.array(_BLACK, np.float32)
        return (bars ^ flip) & ~seam, yellow * np.float32(rng.uniform(0.7, 1.15)), black * np.ones(3, np.float32)
    if paint_name == "white_stripes":
        return bars, white, base
    if paint_name == "white_triangles":
        edge = np.minimum(along, 1 - along) * 2 if rng.random() < 0.5 else 1 - np.abs(2 * along - 1)
        width = min(0.9, max(0.35, 0.5 * feature.length_m))
        return np.abs(np.mod(across / width, 1.0) - 0.5) < 0.5 * (1 - edge), white, base
    if paint_name == "zebra":
        middle = (along > 0.18) & (along < 0.82)
        return bars & middle, white, base
    if paint_name == "red":
        brick = (np.mod(across, 0.2) < 0.02) | (np.mod(along * feature.length_m, 0.1) < 0.02)
        return 0.9 - 0.3 * brick, np.array(_RED, np.float32), base
    return np.zeros(along.shape, bool), white, base


def _pothole(
    block: "Block",
    part: tuple[slice, slice],
    hole: Pothole,
    footprint: np.ndarray,
    rng: np.random.Generator,
) -> None:
    x, y = block.x[part[0]], block.y[:, part[1]]
    sink = np.clip(-np.asarray(hole.height(x, y)) / hole.depth_m, 0, 1)
    shape = footprint.shape
    lumps = _local_noise(hole, x, y, (0.5, 0.5, 0.5, 0.5), rng)
    fill = _FILLS[str(rng.choice(list(_FILLS), p=(0.45, 0.35, 0.2)))]
    inner = np.array(fill, np.float32) * np.float32(rng.uniform(0.7, 1.2))
    inner = inner * np.clip(1 + 0.45 * lumps, 0.3, 2.2)[..., None]
    wall = np.clip(sink * 3, 0, 1)[..., None]
    rim = np.float32(rng.uniform(0.55, 0.9))  # freshly broken asphalt is darker than the worn top
    skin = block.albedo[part] * rim * (1 - wall) + inner * wall
    block.albedo[part] = np.where(footprint[..., None], skin, block.albedo[part]).astype(np.float32)
    _debris(block, part, hole, footprint, lumps, rng)
    if rng.random() < 0.25:
        level = rng.uniform(0.45, 0.85)
        water = np.clip((sink - level) / 0.12, 0, 1).reshape(shape).astype(np.float32)
        mud = np.array(_FILLS["mud"], np.float32) * 0.8
        block.albedo[part] = block.albedo[part] * (1 - water[..., None]) + mud * water[..., None]
        block.wet[part] = np.maximum(block.wet[part], water)


def _debris(
    block: "Block",
    part: tuple[slice, slice],
    hole: Pothole,
    footprint: np.ndarray,
    lumps: np.ndarray,
    rng: np.random.Generator,
) -> None:
    """Loose gravel and dust thinning out around the rim."""
    x, y = block.x[part[0]], block.y[:, part[1]]
    reach = np.hypot(
        (x - hole.start_m - hole.length_m / 2) / (hole.length_m / 2), (y - hole.y_m) / (hole.width_m / 2)
    )
    near = np.clip(1.9 - reach, 0, 1) * ~footprint
    speckle = _local_noise(hole, x, y, (1.0,), rng)
    amount = rng.uniform(0, 0.5)
    gain = 1 + amount * near * np.clip(speckle * 0.9 + 0.3 * lumps, -0.8, 1.6)
    block.albedo[part] *= gain[..., None].astype(np.float32)


def _local_noise(
    hole: Pothole, x: np.ndarray, y: np.ndarray, amplitudes: tuple[float, ...], rng: np.random.Generator
) -> np.ndarray:
    """Noise tied to the hole, so that it does not depend on which block paints it."""
    cell = float(x[1, 0] - x[0, 0]) if len(x) > 1 else 0.02
    span = (int((hole.length_m + 1.2) / cell) + 2, int((hole.width_m + 1.2) / cell) + 2)
    field = fractal(rng, span, amplitudes)
    i = np.clip(np.rint((x[:, 0] - hole.start_m + 0.55) / cell).astype(int), 0, span[0] - 1)
    j = np.clip(np.rint((y[0] - hole.y_m + hole.width_m / 2 + 0.55) / cell).astype(int), 0, span[1] - 1)
    return field[i[:, None], j[None]]
