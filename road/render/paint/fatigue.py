"""Fatigue (alligator) cracking: fields of polygons between cracks, around potholes and in wheel tracks."""

from collections.abc import Iterator, Sequence

import numpy as np

from foreride.road.features.feature import Feature
from foreride.road.obstacle_classes import HOLES
from foreride.road.render.appearance import Appearance
from foreride.road.render.paint.damage import Crack

POLYGON_M = (0.09, 0.25)
"""Range of the size of the polygons."""
_FIELDS_PER_60_M = 6.0  # away from potholes, at a fatigue of 1


def plan(
    rng: np.random.Generator,
    appearance: Appearance,
    features: Sequence[Feature],
    edges: tuple[float, float],
    length_m: float,
) -> tuple[Crack, ...]:
    """Cracks of all fields of a road; none at a fatigue of 0."""
    cracks: list[Crack] = []
    for hole in (feature for feature in features if feature.cls in HOLES):
        if rng.random() < appearance.fatigue:
            size = np.array((hole.end_m - hole.start_m, hole.y_max_m - hole.y_min_m))
            centre = np.array((hole.start_m + hole.end_m, hole.y_min_m + hole.y_max_m)) / 2
            cracks += _field(rng, centre, size / 2 + rng.uniform(0.15, 0.7, 2))
    for _ in range(rng.poisson(_FIELDS_PER_60_M * appearance.fatigue * length_m / 60.0)):
        centre = np.array((rng.uniform(0, length_m), rng.uniform(edges[0] + 0.3, edges[1] - 0.3)))
        cracks += _field(rng, centre, np.array((rng.uniform(0.5, 2.5), rng.uniform(0.2, 0.6))))
    return tuple(cracks)


def _field(rng: np.random.Generator, centre: np.ndarray, half_axes: np.ndarray) -> Iterator[Crack]:
    """Cracks of one elliptic field, fewer towards its edge."""
    from scipy.spatial import Voronoi  # slow to import, and most roads have no such cracks

    pitch, factor = rng.uniform(*POLYGON_M), rng.uniform(0.3, 0.65)
    counts = np.ceil(2 * half_axes / pitch).astype(int) + 2
    lattice = np.stack(np.meshgrid(*(np.arange(count) for count in counts), indexing="ij"), axis=-1)
    jittered = lattice.reshape(-1, 2) + rng.uniform(-0.45, 0.45, (counts.prod(), 2))
    diagram = Voronoi(pitch * (jittered - (counts - 1) / 2))
    for ridge in diagram.ridge_vertices:
        line = diagram.vertices[ridge]
        if min(ridge) >= 0 and np.hypot(*(line / half_axes).T).max() < rng.uniform(0.6, 1.1):
            width, darkness = rng.uniform(0.01, 0.03), factor * rng.uniform(0.8, 1.4)
            yield Crack(centre + line, float(width), float(min(darkness, 0.95)))
