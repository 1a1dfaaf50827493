"""Dust, puddles and snow in their places; crumbled potholes within their outlines."""

from typing import Any

import numpy as np

from foreride.road.features.feature import Pothole
from foreride.road.render.appearance import Appearance
from foreride.road.render.ground_map import Surface
from foreride.road.render.map_tile import CELL_M, HALF_WIDTH_M, START_M
from foreride.road.road import Road

EDGES: dict[str, Any] = {"left_edge_m": 3.5, "right_edge_m": -3.5}


def lit(
    appearance: Appearance, features: tuple = (), seed: int = 0
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Radiance (rows, cols, 3) and wetness (rows, cols) of the first 20 m, and y of the columns."""
    surface = Surface(Road(20.0, features), appearance, seed)
    surface.extend(20.0)
    level = surface.atlas[: int(20 / CELL_M)].astype(float) / 255
    y = -HALF_WIDTH_M + (np.arange(level.shape[1]) + 0.5) * CELL_M
    return level[..., :3] ** 2, level[..., 3], y


def rows(low: float, high: float) -> slice:
    return slice(int((low - START_M) / CELL_M), int((high - START_M) / CELL_M))


def test_dust_lies_along_the_edges() -> None:
    clean, _, y = lit(
        Appearance(verge="red_soil", cracks=0, patches=0, distractors=0, edge_lines=False, **EDGES)
    )
    dusty, _, _ = lit(
        Appearance(verge="red_soil", dirt=0.8, cracks=0, patches=0, distractors=0, edge_lines=False, **EDGES)
    )
    change = np.abs(dusty - clean).mean(axis=(0, 2))
    edge, track = change[(np.abs(y) > 2.9) & (np.abs(y) < 3.3)], change[np.abs(np.abs(y) - 0.8) < 0.2]
    assert edge.mean() > 2 * track.mean()
    redness = dusty[..., 0].mean(axis=0) / dusty[..., 2].mean(axis=0)
    assert redness[(y > 2.9) & (y < 3.3)].mean() > redness[np.abs(y) < 0.3].mean() + 0.1


def test_puddles_are_wet_and_a_dry_road_is_not() -> None:
    assert lit(Appearance(puddles=0.0, **EDGES))[1].max() == 0
    wet = lit(Appearance(puddles=1.0, **EDGES))[1]
    assert wet.max() > 0.9
    assert 0.002 < (wet > 0.5).mean() < 0.4


def test_snow_is_deepest_beside_the_road_and_thinnest_in_the_tracks() -> None:
    bright = np.mean(
        [lit(Appearance(weather="snow", brightness=0.1, **EDGES), (), s)[0] for s in range(3)], axis=0
    )
    y = lit(Appearance(**EDGES))[2]
    across = bright.mean(axis=(0, 2))
    verge, middle = across[np.abs(y) > 5].mean(), across[np.abs(y) < 0.2].mean()
    track = across[np.abs(np.abs(y) - 0.8) < 0.15].mean()
    assert verge > middle > track


def test_litter_is_small_and_scattered() -> None:
    clean, _, _ = lit(Appearance(**EDGES))
    littered, _, _ = lit(Appearance(litter=1.0, **EDGES))
    changed = np.abs(littered - clean).max(axis=2) > 0.01
    assert 1e-4 < changed.mean() < 0.02
    assert changed[:, np.abs(lit(Appearance())[2]) > 4.2].sum() == 0


def test_a_crumbled_pothole_changes_its_surroundings_only_near_by() -> None:
    hole = Pothole(9.0, 0.06, 0.8, 0.7, y_m=0.5, seed=3)
    for seed in range(3):
        crumbled, wet, y = lit(Appearance(decay=1.0, **EDGES), (hole,), seed)
        same, _, _ = lit(Appearance(**EDGES), (hole,), seed)
        changed = np.abs(crumbled - same).max(axis=2) > 1e-3
        assert not changed[:, np.abs(y - 0.5) > 1.05].any()
        assert not changed[rows(0, 8.3)].any()
        assert not changed[rows(10.5, 17)].any()
        assert (wet[rows(9.0, 9.8)] > 0).sum() == (wet > 0).sum()  # water stays in the hole


def test_some_old_potholes_hold_water_and_more_of_them_in_the_rain() -> None:
    def share(weather: str) -> float:
        holes = tuple(Pothole(1.0 + 2 * k, 0.06, 0.8, 0.7, seed=k) for k in range(9))
        full = []
        for seed in range(2):
            wet = lit(Appearance(decay=1.0, weather=weather, **EDGES), holes, seed)[1]
            full += [wet[rows(h.start_m, h.end_m), 380:440].max() > 0.95 for h in holes]
        return float(np.mean(full))

    dry = share("dry")
    assert 0.1 < dry < 0.6
    assert share("wet") > dry
