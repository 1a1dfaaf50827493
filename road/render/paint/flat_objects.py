"""Outlines of flat things on a road that look like obstacles, by their auxiliary class."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from foreride.road.render.paint.damage import MANHOLE_RADIUS_M, Damage
from foreride.road.render.paint.deposits import LooseCover
from foreride.road.render.paint.markings import Markings

_FAINT_STAIN = 0.85
"""Relative albedo from which on a stain is too faint to be labelled."""


class FlatObject(NamedTuple):
    """Flat object: its class, one of `road.obstacle_classes.AUXILIARY_NAMES`, and corners (n, 2) x, y, m."""

    kind: str
    outline: np.ndarray


def outlined(damage: Damage, marks: Markings, cover: LooseCover) -> tuple[FlatObject, ...]:
    """All flat objects of a road. A stop line counts as a crossing: both lie across the lane."""
    return tuple(FlatObject(kind, outline) for kind, outline in _outlines(damage, marks, cover))


def _outlines(damage: Damage, marks: Markings, cover: LooseCover) -> Iterator[tuple[str, np.ndarray]]:
    for bar in marks.bars:
        near, far, right, left = bar.x0_m, bar.x1_m, bar.y0_m, bar.y1_m
        yield "crossing", np.array(((near, right), (far, right), (far, left), (near, left)))
    for arrow in marks.arrows:
        yield "arrow", arrow
    for patch in damage.patches:
        yield "patch", patch.outline
    for x, y in damage.manholes:
        yield "cover", _ellipse(x, y, MANHOLE_RADIUS_M, MANHOLE_RADIUS_M)
    for x, y, radius in cover.puddles:
        yield "puddle", _ellipse(x, y, 1.7 * radius, radius)
    for x, y, radius, factor in damage.stains:
        if factor < _FAINT_STAIN:
            yield "stain", _ellipse(x, y, 1.6 * radius, radius)


def _ellipse(x: float, y: float, along_m: float, across_m: float) -> np.ndarray:
    angle = np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False)
    return np.stack((x + along_m * np.cos(angle), y + across_m * np.sin(angle)), axis=1)
