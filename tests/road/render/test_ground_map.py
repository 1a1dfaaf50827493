"""Ground map against the road it represents, and against itself filled in another order."""

import numpy as np

from foreride.road.features.feature import Feature, HalfSineBump, Pothole, Step, WattsHump
from foreride.road.render.appearance import Appearance
from foreride.road.render.ground_map import BLOCK_ROWS, COLUMNS, Surface
from foreride.road.render.map_tile import CELL_M, HALF_WIDTH_M, LEVEL_COLUMN_SHIFTS, START_M
from foreride.road.road import Road
from foreride.road.roughness.iso8608 import Roughness

FEATURES: tuple[Feature, ...] = (
    HalfSineBump(4.0, 0.08, 0.4, -2.0, 1.0),
    WattsHump(9.5, 0.09, 3.6),  # lies across the border of the first two blocks, at 10.8 m
    Pothole(20.0, 0.08, 0.7, 0.9, y_m=-0.75, irregularity=0.4, seed=3),
)
ROAD = Road(30.0, FEATURES, Roughness("C", 2))
LOOK = Appearance(verge="grass")


def cell_centres(surface: Surface) -> tuple[np.ndarray, np.ndarray]:
    x = START_M + (np.arange(surface.rows) + 0.5)[:, None] * CELL_M
    return x, -HALF_WIDTH_M + (np.arange(COLUMNS) + 0.5)[None] * CELL_M


def test_height_is_that_of_the_road() -> None:
    surface = Surface(ROAD, LOOK, 0)
    surface.extend(40.0)
    x, y = cell_centres(surface)
    rows = (x[:, 0] > 0) & (x[:, 0] < 28)
    np.testing.assert_allclose(surface.map.height[rows], ROAD.height(x[rows], y), atol=1e-3)


def test_steps_and_measured_heights_are_seen_between_features_too(tmp_path) -> None:
    path = tmp_path / "road.csv"
    path.write_text("x_m,left_m,right_m\n0,0,0\n8,0.05,0\n14,0.05,0.03\n40,0,0\n")
    road = Road(30.0, (Step(6.0, 0.06), Step(20.0, -0.06)), file=str(path))
    surface = Surface(road, LOOK, 0)
    surface.extend(30.0)
    x, y = cell_centres(surface)
    rows, lane = (x[:, 0] > 0) & (x[:, 0] < 28), np.abs(y[0]) < 3
    np.testing.assert_allclose(surface.map.height[rows][:, lane], road.height(x[rows], y[:, lane]), atol=2e-3)


def test_ids_are_the_footprints() -> None:
    surface = Surface(ROAD, LOOK, 0)
    surface.extend(40.0)
    x, y = cell_centres(surface)
    for number, feature in enumerate(FEATURES):
        np.testing.assert_array_equal(surface.map.ids == number + 1, feature.footprint(x, y))


def test_filling_step_by_step_gives_the_same_map() -> None:
    once, stepwise = Surface(ROAD, LOOK, 5), Surface(ROAD, LOOK, 5)
    once.extend(60.0)
    for x in (0.0, 11.0, 30.0, 60.0):
        stepwise.extend(x)
    for name in ("atlas", "strip"):
        np.testing.assert_array_equal(getattr(once, name), getattr(stepwise, name))
    for one, other in zip(once.map, stepwise.map, strict=True):
        np.testing.assert_array_equal(one, other)


def test_blocks_join_without_a_seam() -> None:
    surface = Surface(Road(30.0), Appearance(cracks=0.0, patches=0.0, distractors=0.0, edge_lines=False), 1)
    surface.extend(40.0)
    road = surface.atlas[: surface.rows, 300:500, :3].astype(float)
    steps = np.abs(np.diff(road, axis=0)).mean(axis=(1, 2))
    borders = np.arange(BLOCK_ROWS, surface.rows, BLOCK_ROWS)[:2] - 1
    assert steps[borders].max() < 3 * steps[: 2 * BLOCK_ROWS].mean() + 0.5


def test_mip_levels_keep_the_mean() -> None:
    surface = Surface(ROAD, LOOK, 0)
    surface.extend(80.0)
    first, means = 0, []
    for level, shift in enumerate(LEVEL_COLUMN_SHIFTS):
        rows = surface.rows >> level
        means.append(surface.atlas[first : first + rows, : COLUMNS >> shift, :3].mean())
        first += rows
    assert first == len(surface.atlas)
    np.testing.assert_allclose(means, means[0], atol=1.0)


def test_height_range_bounds_the_map() -> None:
    surface = Surface(ROAD, LOOK, 0)
    surface.extend(40.0)
    low, high = surface.height_range(0.0, 30.0)
    assert surface.map.height[:1600].min() - 0.01 < low <= surface.map.height[:1600].min()
    assert surface.map.height[:1600].max() <= high < surface.map.height[:1600].max() + 0.01
