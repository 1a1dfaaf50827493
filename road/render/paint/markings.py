"""Road markings: lane lines, stop lines, pedestrian crossings and arrows, with their wear."""

from dataclasses import dataclass

import cv2
import numpy as np

from foreride.road.render.appearance import Appearance
from foreride.road.render.map_tile import CELL_M, Block

_ARROWS_PER_60_M = 4.0
"""At a density of arrows of 1."""
_STRAIGHT = ((0, -0.08), (3.2, -0.08), (3.2, -0.3), (5, 0), (3.2, 0.3), (3.2, 0.08), (0, 0.08))
_TURN = ((0, -0.08), (2.6, -0.08), (3.4, 0.1), (4.4, 0.55), (3.4, 1.0), (3.4, 0.6), (2.3, 0.08), (0, 0.08))
"""Outlines of arrows, x ahead and y to the left, m."""
_COLOURS = {"white": (0.62, 0.62, 0.60), "yellow": (0.56, 0.38, 0.06)}


@dataclass(frozen=True)
class Line:
    """Longitudinal line marking.

    y_m, width_m: centre and width. dash_m, gap_m: lengths of dash and gap, gap 0 for a solid line. phase_m:
    offset of the pattern along the road.
    """

    y_m: float
    width_m: float
    dash_m: float
    gap_m: float
    phase_m: float


@dataclass(frozen=True)
class Bars:
    """Transverse marking from x0 to x1 between two y, broken into bars of `bar_m` (0: one stop line)."""

    x0_m: float
    x1_m: float
    y0_m: float
    y1_m: float
    bar_m: float


@dataclass(frozen=True)
class Markings:
    """Markings of a whole road."""

    lines: tuple[Line, ...]
    bars: tuple[Bars, ...]
    colour: tuple[float, float, float]
    wear: float
    arrows: tuple[np.ndarray, ...] = ()  # outlines (n, 2)


def plan(
    rng: np.random.Generator, appearance: Appearance, edges: tuple[float, float], length_m: float
) -> Markings:
    """Random markings of a whole road."""
    right, left = edges
    inset, width = rng.uniform(0.12, 0.35), rng.uniform(0.10, 0.16)
    lines = []
    if appearance.edge_lines:
        lines += [Line(y, width, 1.0, 0.0, 0.0) for y in (right + inset, left - inset)]
    middle = _divider(right, left)
    dash, gap, phase = rng.uniform(1.5, 5), rng.uniform(2, 8), rng.uniform(0, 10)
    if appearance.centre_line == "double":
        lines += [Line(middle + s, width, 1.0, 0.0, 0.0) for s in (-0.12, 0.12)]
    elif appearance.centre_line != "none":
        lines.append(Line(middle, width, dash, gap if appearance.centre_line == "dashed" else 0.0, phase))
    bars = []
    for _ in range(rng.poisson(1.2 * appearance.distractors * length_m / 60)):
        start = rng.uniform(4, length_m)
        if rng.random() < 0.6:
            bars.append(
                Bars(start, start + rng.uniform(2, 4), right + 0.4, left - 0.4, rng.uniform(0.4, 0.6))
            )
        else:
            bars.append(Bars(start, start + rng.uniform(0.25, 0.5), right + 0.3, middle, 0.0))
    return Markings(tuple(lines), tuple(bars), _COLOURS[appearance.line_colour], appearance.wear)


def plan_arrows(
    rng: np.random.Generator, appearance: Appearance, edges: tuple[float, float], length_m: float
) -> tuple[np.ndarray, ...]:
    """Outlines of the arrows of a whole road, in the middle of either lane; none at a density of 0."""
    right, left = edges
    middle, arrows = _divider(right, left), []
    for _ in range(rng.poisson(_ARROWS_PER_60_M * appearance.arrows * length_m / 60)):
        direction, side = rng.choice((-1.0, 1.0), 2)
        size = direction * rng.uniform(0.6, 1.2), side * rng.uniform(0.8, 1.4)
        lane = (right + middle) / 2 if rng.random() < 0.7 else (middle + left) / 2
        outline = np.array((_STRAIGHT, _TURN)[rng.integers(2)])
        arrows.append(outline * size + (rng.uniform(4, length_m), lane))
    return tuple(arrows)


def paint(block: Block, marks: Markings) -> None:
    """Paint the markings into the block's albedo; edges are anti-aliased over one cell."""
    paint_left = np.clip(1.15 - 0.75 * marks.wear + (0.3 + 0.9 * marks.wear) * block.noise["wear"], 0.0, 1.0)
    for line in marks.lines:
        columns = np.flatnonzero(np.abs(block.y[0] - line.y_m) < line.width_m / 2 + CELL_M)
        if len(columns):
            part = (slice(None), slice(columns[0], columns[-1] + 1))
            across = _cover(line.width_m / 2 - np.abs(block.y[part] - line.y_m))
            _blend(block, part, across * _dashes(block.x, line), paint_left, marks.colour)
    for bar in marks.bars:
        if block.reaches(bar.x0_m, bar.x1_m, CELL_M):
            part = (block.rows(bar.x0_m - CELL_M, bar.x1_m + CELL_M), slice(None))
            along = _cover(np.minimum(block.x[part[0]] - bar.x0_m, bar.x1_m - block.x[part[0]]))
            across = _cover(np.minimum(block.y - bar.y0_m, bar.y1_m - block.y))
            if bar.bar_m:
                across = across * (np.mod(block.y - bar.y0_m, 2 * bar.bar_m) < bar.bar_m)
            _blend(block, part, along * across, paint_left, _COLOURS["white"])
    for outline in marks.arrows:
        if block.reaches(outline[:, 0].min(), outline[:, 0].max(), CELL_M):
            cover = np.zeros(block.height.shape, np.float32)
            cv2.fillPoly(cover, [block.corners(outline)], 1.0, cv2.LINE_AA, 4)
            rows = block.rows(outline[:, 0].min() - CELL_M, outline[:, 0].max() + CELL_M)
            _blend(block, (rows, slice(None)), cover[rows], paint_left, _COLOURS["white"])


def _divider(right: float, left: float) -> float:
    """y of the lane divider: beside the ego lane on a two-lane road, otherwise in the middle."""
    if abs(left + right) < 1.0:
        return (left + right) / 2
    return 1.75 if left > -right else -1.75


def _dashes(x: np.ndarray, line: Line) -> np.ndarray:
    if line.gap_m == 0:
        return np.ones_like(x)
    position = np.mod(x + line.phase_m, line.dash_m + line.gap_m)
    return _cover(np.minimum(position, line.dash_m - position))


def _cover(inside_m: np.ndarray) -> np.ndarray:
    """Covered share of a cell, from the signed distance of its centre to the edge."""
    return np.clip(inside_m / CELL_M + 0.5, 0, 1)


def _blend(
    block: Block,
    part: tuple[slice, slice],
    cover: np.ndarray,
    paint_left: np.ndarray,
    colour: tuple[float, ...],
) -> None:
    share = (cover * paint_left[part]).astype(np.float32)[..., None]
    paint_colour = np.array(colour, np.float32) * (1 + block.noise["tone"][part])[..., None]
    block.albedo[part] = block.albedo[part] * (1 - share) + paint_colour * share
