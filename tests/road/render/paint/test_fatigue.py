"""Fatigue cracking: absent by default; around potholes and elsewhere where asked for, in small polygons."""

import numpy as np
import pytest

from foreride.road.features.feature import HalfSineBump, Pothole
from foreride.road.render.appearance import Appearance
from foreride.road.render.paint.fatigue import POLYGON_M, plan

EDGES = (-3.8, 3.8)
HOLE = Pothole(30.0, 0.05, 0.8, 0.6, 0.5)


def cracks(fatigue: float, *features: Pothole | HalfSineBump, length_m: float = 60.0) -> list[np.ndarray]:
    planned = plan(np.random.default_rng(0), Appearance(fatigue=fatigue), features, EDGES, length_m)
    return [crack.line for crack in planned]


def test_roads_have_none_unless_asked_for() -> None:
    assert cracks(0.0, HOLE) == []
    assert Appearance().fatigue == 0.0


def test_they_surround_a_pothole_and_no_bump() -> None:
    around = np.concatenate(cracks(1.0, HOLE, length_m=1e-9))
    assert len(around) > 30
    centre = np.array([30.4, 0.5])
    assert np.abs(around - centre).max() < 1.5
    assert np.abs(around.mean(axis=0) - centre).max() < 0.2
    assert cracks(1.0, HalfSineBump(30.0, 0.08, 0.4), length_m=1e-9) == []


@pytest.mark.parametrize("fatigue", [0.3, 1.0])
def test_sides_of_polygons_are_short_and_fields_lie_on_the_road(fatigue: float) -> None:
    lines = cracks(fatigue)
    assert len(lines) > 100 * fatigue
    lengths = [float(np.hypot(*(line[1] - line[0]))) for line in lines]
    assert np.median(lengths) < POLYGON_M[1]
    middles = np.array([line.mean(axis=0) for line in lines])
    assert middles[:, 1].min() > EDGES[0] - 1.0
    assert middles[:, 1].max() < EDGES[1] + 1.0
