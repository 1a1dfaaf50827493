"""Delaminated and flooded potholes: absent by default, one even layer, and level water up to near the rim."""

import numpy as np
import pytest

from foreride.road.features.feature import Pothole
from foreride.road.render.appearance import Appearance
from foreride.road.render.ground_map import Surface
from foreride.road.render.map_tile import Block
from foreride.road.road import Road

QUIET = {"cracks": 0.0, "patches": 0.0, "distractors": 0.0, "wear": 0.0}


def painted(hole: Pothole, **fields: float) -> tuple[Block, np.ndarray]:
    """First block of a road with one pothole, and the cells (n, m) in its footprint."""
    block = Surface(Road(12.0, (hole,)), Appearance(**(QUIET | fields)), 3)._paint(0)
    return block, block.ids == 1


def test_potholes_are_neither_unless_asked_for() -> None:
    hole = Pothole(5.0, 0.03, 1.0, 0.8, 0.0)
    plain, _ = painted(hole)
    for field in ("flooding", "delamination"):
        assert getattr(Appearance(), field) == 0.0
        assert not np.array_equal(painted(hole, **{field: 1.0})[0].albedo, plain.albedo)


@pytest.mark.parametrize("depth_m", [0.03, 0.1])
def test_water_is_level_wet_and_below_the_road(depth_m: float) -> None:
    hole = Pothole(5.0, depth_m, 1.0, 0.8, 0.0, irregularity=0.3, seed=2)
    (dry, inside), (block, _) = painted(hole), painted(hole, flooding=1.0)
    water = inside & (block.height > dry.height + 1e-6)
    assert water.sum() > 0.4 * inside.sum()
    assert np.ptp(block.height[water]) < 1e-5  # the road has no roughness
    assert -0.5 * depth_m < block.height[water].mean() < 0.0
    assert block.wet[water].mean() > 0.6
    assert np.array_equal(block.height[~inside], dry.height[~inside])


def test_a_delamination_is_one_even_layer_and_only_shallow() -> None:
    shallow, deep = Pothole(5.0, 0.03, 1.0, 0.8, 0.0), Pothole(5.0, 0.1, 1.0, 0.8, 0.0)
    block, inside = painted(shallow, delamination=1.0)
    floor = inside & (block.height < -0.028)
    tone, road = block.albedo[floor].mean(axis=1), float(block.albedo[~inside].mean())
    assert tone.std() < 0.35 * tone.mean()
    assert abs(tone.mean() / float(np.median(block.albedo[300:340, 380:420])) - 1.0) > 0.1
    assert road > 0.0
    unchanged, _ = painted(deep)
    assert np.array_equal(painted(deep, delamination=1.0)[0].albedo, unchanged.albedo)
