"""Paint of bumps and potholes: markings, rubber, rubble, mud and water on their footprints."""

from dataclasses import dataclass

import numpy as np

from foreride.road.features.feature import Bump, Fitting, Pothole, RoadFeature
from foreride.road.render.appearance import Appearance
from foreride.road.render.map_tile import CELL_M, Block
from foreride.road.render.noise import fractal
from foreride.road.render.paint import crumbled_potholes, worn_potholes
from foreride.road.render.paint.joints_and_covers import fitting_albedo

MARGIN_M = 0.6  # reach of the debris around a pothole
_WHITE, _YELLOW = np.array((0.62, 0.62, 0.60), np.float32), np.array((0.58, 0.40, 0.05), np.float32)
_BLACK, _RED = np.array((0.035, 0.035, 0.035), np.float32), np.array((0.24, 0.10, 0.07), np.float32)
# Filling of a pothole: tint, and least and greatest brightness relative to the road.
_FILLINGS = {
    "broken_asphalt": ((1.06, 1.0, 0.94), 0.4, 0.7),
    "rubble": ((1.12, 1.0, 0.86), 0.55, 1.5),
    "mud": ((1.4, 1.0, 0.62), 0.5, 1.1),
}
_WATER = np.array((0.15, 0.10, 0.065), np.float32)


@dataclass(frozen=True)
class FeatureCells:
    """Part of a block around one feature: index into its fields, x (n, 1), y (1, m), footprint (n, m)."""

    part: tuple[slice, slice]
    x: np.ndarray
    y: np.ndarray
    inside: np.ndarray


def paint(
    block: Block, feature: RoadFeature, number: int, rng: np.random.Generator, appearance: Appearance
) -> None:
    """Paint one feature into the block, if they overlap, and write its id `number`.

    All random numbers come from `rng`, in the same order for every block that shares the feature.
    """
    low, high = feature.start_m - MARGIN_M, feature.end_m + MARGIN_M
    cols = np.flatnonzero(
        (block.y[0] > feature.y_min_m - MARGIN_M) & (block.y[0] < feature.y_max_m + MARGIN_M)
    )
    if not block.reaches(low, high) or not len(cols):
        return
    part = (block.rows(low, high), slice(int(cols[0]), int(cols[-1]) + 1))
    x, y = block.x[part[0]], block.y[:, part[1]]
    spot = FeatureCells(part, x, y, np.asarray(feature.footprint(x, y)))
    block.ids[part][spot.inside] = number
    if isinstance(feature, Pothole):
        _pothole(block, spot, feature, rng, appearance)
    elif isinstance(feature, Bump):
        _bump(block, spot, feature, rng, appearance)
    else:
        albedo = block.albedo[part]
        if isinstance(feature, Fitting):
            skin = fitting_albedo(albedo, x, y, feature, rng)
        else:
            skin = feature.painted(albedo, x, y, rng)
        np.copyto(albedo, skin, where=spot.inside[..., None])


def _bump(
    block: Block, spot: FeatureCells, feature: Bump, rng: np.random.Generator, appearance: Appearance
) -> None:
    # A bump is laid later than the road around it: darker or lighter, with a joint at either edge.
    if feature.paint == "bare":
        _bare(block, spot, feature, rng)
        return
    factor = rng.uniform(0.55, 0.85) if rng.random() < 0.6 else rng.uniform(1.12, 1.4)
    base = np.full(3, appearance.brightness * factor, np.float32)
    along = (spot.x - feature.start_m) / feature.length_m
    along, across = np.broadcast_arrays(along, spot.y - feature.y_min_m)
    cover, marking, body = _pattern(feature, along, across, base, rng)
    paint_left = 1.2 - 0.8 * appearance.wear + (0.2 + 0.7 * appearance.wear) * block.noise["wear"][spot.part]
    paint_left -= appearance.paint_wear * (0.6 + 0.5 * block.noise["wear"][spot.part])
    share = (cover * np.clip(paint_left, 0.1 * (1 - 0.8 * appearance.paint_wear), 1)).astype(np.float32)[
        ..., None
    ]
    joint = np.minimum(along, 1 - along) * feature.length_m < 0.025
    tone = (1 + block.noise["tone"][spot.part]) * (1 - rng.uniform(0.1, 0.5) * joint).astype(np.float32)
    painted = (body * (1 - share) + marking * share) * tone[..., None]
    np.copyto(block.albedo[spot.part], painted, where=spot.inside[..., None])


def _bare(block: Block, spot: FeatureCells, feature: Bump, rng: np.random.Generator) -> None:
    """Unpainted bump of the road's own material: shading, a seam at either edge, and tyre scuffs."""
    noise = block.noise["wear"][spot.part]
    from_edge = np.minimum(spot.x - feature.start_m, feature.end_m - spot.x)
    seam = np.exp(-((from_edge / rng.uniform(0.02, 0.07)) ** 2)) * np.clip(0.7 + 0.8 * noise, 0, 1)
    scuff = np.exp(-(((np.abs(spot.y) - 0.8) / 0.3) ** 2)) * np.clip(0.6 + noise, 0, 1.5)
    gain = (
        rng.uniform(0.85, 1.12) * (1 - rng.uniform(0.1, 0.5) * seam) * (1 + rng.uniform(-0.2, 0.15) * scuff)
    )
    albedo = block.albedo[spot.part]
    np.copyto(albedo, albedo * gain.astype(np.float32)[..., None], where=spot.inside[..., None])


def _pattern(
    feature: Bump, along: np.ndarray, across: np.ndarray, base: np.ndarray, rng: np.random.Generator
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Painted share, paint colour and base colour of a bump's marking.

    The share is (n, m) in 0..1, colours are (3,) or (n, m, 3). along: 0..1 from the near to the far edge;
    across: metres from the right end.
    """
    name = feature.paint
    bar, slant = rng.uniform(0.25, 0.55), rng.choice((0.0, 0.5, -0.5))
    flip = (along > 0.5) & (rng.random() < 0.3)  # rubber humps whose two halves alternate
    bars = np.mod(np.floor(across / bar + slant * along), 2) == 0
    strength, pointed = np.float32(rng.uniform(0.7, 1.15)), rng.random() < 0.5
    if name == "yellow_black":
        return (bars ^ flip) & (np.mod(across, bar) > 0.02), _YELLOW * strength, _BLACK
    if name == "white_stripes":
        return bars, _WHITE, base
    if name == "zebra":
        return bars & (along > 0.18) & (along < 0.82), _WHITE, base
    if name == "white_triangles":
        ramp = 1 - 2 * np.minimum(along, 1 - along) if pointed else np.abs(2 * along - 1)
        width = min(0.9, max(0.35, 0.5 * feature.length_m))
        return np.abs(np.mod(across / width, 1.0) - 0.5) < 0.5 * (1 - ramp), _WHITE, base
    if name == "red":
        brick = (np.mod(across, 0.2) < 0.02) | (np.mod(along * feature.length_m, 0.1) < 0.02)
        return 0.9 - 0.3 * brick, _RED, base
    return _street_pattern(feature, along, across, base, rng)


def _street_pattern(
    feature: Bump, along: np.ndarray, across: np.ndarray, base: np.ndarray, rng: np.random.Generator
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Painted share and colours, as `_pattern`, of markings seen on Indian streets and campus roads."""
    bar, lean = rng.uniform(0.25, 0.7), rng.uniform(-1.2, 1.2)
    if feature.paint == "rubber":
        return _rubber(feature, along, across, rng)
    if feature.paint == "slanted":
        return np.mod(across / bar + lean * along, 2) < rng.uniform(0.8, 1.3), _WHITE, base
    if feature.paint == "white_yellow":
        stripe = np.mod(np.floor(across / bar + lean * along), rng.choice((2, 4)))
        colour = np.where((stripe % 4 == 0)[..., None], _WHITE, _YELLOW)
        return (stripe % 2 == 0) | (rng.random() < 0.4), colour, base
    if feature.paint == "zigzag":
        wave = 0.2 + 0.6 * np.abs(2 * np.mod(across / (3 * bar), 1) - 1)
        return np.abs(along - wave) < rng.uniform(0.1, 0.22), (_WHITE, _YELLOW)[rng.integers(2)], base
    return np.zeros(along.shape, np.float32), base, base


def _rubber(
    feature: Bump, along: np.ndarray, across: np.ndarray, rng: np.random.Generator
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Rubber bump: bolted segments, black and yellow in turn, with ribs, round black ends and cat's eyes."""
    segment = rng.choice((0.25, 0.5, rng.uniform(0.2, 0.6)))
    width = feature.y_max_m - feature.y_min_m
    position = np.mod(across, segment)
    yellow = np.mod(np.floor(across / segment), 2) == 0
    yellow &= (across > 0.15) & (across < width - 0.15) & (position > 0.012)
    if rng.random() < 0.5:  # coloured inlay with a black frame
        yellow &= (along > 0.12) & (along < 0.88) & (position > 0.03) & (position < segment - 0.03)
    ribs = 1 - 0.35 * (np.mod(along * feature.length_m, 0.05) < 0.02)
    eyes = ~yellow & (np.abs(position - segment / 2) < 0.05) & (np.abs(along - 0.25) < 0.09)
    eyes &= rng.random() < 0.6
    body = np.where(eyes[..., None], _WHITE, _BLACK * np.float32(rng.uniform(0.8, 2.2)) * ribs[..., None])
    return yellow, _YELLOW * np.float32(rng.uniform(0.75, 1.35)), body.astype(np.float32)


def _pothole(
    block: Block, spot: FeatureCells, hole: Pothole, rng: np.random.Generator, appearance: Appearance
) -> None:
    shallow = hole.depth_m <= worn_potholes.LAYER_DEPTH_M
    if shallow and appearance.delamination and rng.random() < appearance.delamination:
        worn_potholes.delaminate(block, spot.part, hole, _pothole_cells(hole, spot, rng), rng)
    else:
        _broken_pothole(block, spot, hole, rng, appearance)
    if appearance.flooding and rng.random() < appearance.flooding:
        worn_potholes.flood(block, spot.part, hole, _pothole_cells(hole, spot, rng), rng)


def _pothole_cells(
    hole: Pothole, spot: FeatureCells, rng: np.random.Generator
) -> crumbled_potholes.PotholeCells:
    lumps, stones = (_noise_at(hole, spot, octaves, rng) for octaves in ((0.5, 0.5, 0.5, 0.4), (1.0,)))
    return crumbled_potholes.PotholeCells(spot.x, spot.y, spot.inside, lumps, stones)


def _broken_pothole(
    block: Block, spot: FeatureCells, hole: Pothole, rng: np.random.Generator, appearance: Appearance
) -> None:
    if appearance.decay and rng.random() < 0.35 + 0.5 * appearance.decay:
        cells = _pothole_cells(hole, spot, rng)
        crumbled_potholes.paint(block, spot.part, hole, cells, rng, appearance)
        return
    relative_depth = np.clip(-np.asarray(hole.height(spot.x, spot.y)) / hole.depth_m, 0, 1).astype(np.float32)
    lumps = _noise_at(hole, spot, (0.5, 0.5, 0.5, 0.5), rng)
    tint, min_gain, max_gain = _FILLINGS[str(rng.choice(list(_FILLINGS), p=(0.6, 0.25, 0.15)))]
    mean_albedo = np.array(tint, np.float32) * np.float32(
        appearance.brightness * rng.uniform(min_gain, max_gain)
    )
    filling = mean_albedo * np.clip(1 + 0.45 * lumps, 0.3, 2.2)[..., None]
    rim = np.float32(rng.uniform(0.55, 0.9))  # freshly broken asphalt is darker than the worn top
    wall = np.clip(relative_depth * 3, 0, 1)[..., None]
    albedo = block.albedo[spot.part]
    np.copyto(albedo, albedo * rim * (1 - wall) + filling * wall, where=spot.inside[..., None])
    _scatter_debris(albedo, spot, hole, lumps, rng)
    if rng.random() < 0.25:
        water = np.clip((relative_depth - rng.uniform(0.45, 0.85)) / 0.12, 0, 1)
        albedo += (_WATER - albedo) * water[..., None]
        block.wet[spot.part] = np.maximum(block.wet[spot.part], water)


def _scatter_debris(
    albedo: np.ndarray, spot: FeatureCells, hole: Pothole, lumps: np.ndarray, rng: np.random.Generator
) -> None:
    """Loose gravel and dust, thinning out around the rim."""
    u = (spot.x - hole.start_m - hole.length_m / 2) / (hole.length_m / 2)
    v = (spot.y - hole.y_m) / (hole.width_m / 2)
    debris_density = np.clip(1.9 - np.hypot(u, v), 0, 1) * ~spot.inside
    speckle = np.clip(0.9 * _noise_at(hole, spot, (1.0,), rng) + 0.3 * lumps, -0.8, 1.6)
    albedo *= (1 + rng.uniform(0, 0.5) * debris_density * speckle)[..., None].astype(np.float32)


def _noise_at(
    hole: Pothole, spot: FeatureCells, amplitudes: tuple[float, ...], rng: np.random.Generator
) -> np.ndarray:
    """Noise (n, m) fixed to the pothole, independent of the block being painted."""
    corner = (hole.start_m - MARGIN_M, hole.y_min_m - MARGIN_M)
    size = tuple(int((extent + 2 * MARGIN_M) / CELL_M) + 2 for extent in (hole.length_m, hole.width_m))
    field = fractal(rng, (size[0], size[1]), amplitudes)
    i = np.clip(((spot.x[:, 0] - corner[0]) / CELL_M).astype(int), 0, size[0] - 1)
    j = np.clip(((spot.y[0] - corner[1]) / CELL_M).astype(int), 0, size[1] - 1)
    return field[i[:, None], j[None]]
