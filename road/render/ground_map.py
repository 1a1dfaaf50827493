"""Ground map of a road: height, feature ids and radiance on a 2 cm grid, filled as the camera advances."""

from dataclasses import replace

import cv2
import numpy as np

from foreride.road.render import lighting
from foreride.road.render.appearance import Appearance
from foreride.road.render.map_tile import (
    CELL_M,
    HALF_WIDTH_M,
    LEVEL_COLUMN_SHIFTS,
    MASK_CELLS,
    START_M,
    Block,
    empty_height_map,
)
from foreride.road.render.noise import fractal
from foreride.road.render.paint import damage, deposits, fatigue, flat_objects, markings, obstacles, pavement
from foreride.road.render.paint.flat_objects import FlatObject
from foreride.road.render.raycast import COARSE_STEP_M
from foreride.road.road import Road

COLUMNS = int(2 * HALF_WIDTH_M / CELL_M)
BLOCK_ROWS = 640
HALO_ROWS = 40  # rows beyond a block that shadows and shading use
COARSENING = 4  # the smooth random fields have a grid coarser by this factor
BEYOND_END_M = 50.0  # length of the map past the road's end, so that the view stays filled
_FINE_STEP_SLOPE = 0.3  # lateral slope (a kerb) from which on the ray caster takes fine steps
_OCTAVES = {
    "tone": (0.05, 0.05, 0.04, 0.04, 0.03, 0.03, 0.03),
    "wear": (0.1, 0.15, 0.2, 0.3, 0.35),
    "dirt": (0.3, 0.3, 0.25, 0.2, 0.15, 0.1),
    "foliage": (0.6, 0.5, 0.4, 0.35, 0.25),
}


class Surface:
    """Ground maps of one scene, rows along x from START_M, columns along y from -HALF_WIDTH_M.

    map: heights and feature ids.
    atlas: (rows x 127/64, cols, 4) uint8, mip levels of encoded radiance and wetness (see `lighting.shade`)
    one below the other; level k has rows >> k rows and cols >> LEVEL_COLUMN_SHIFTS[k] columns.
    strip: (cols, 4) float32, the last level's average along the road's beginning.
    reflects: whether any of the filled map is wet.

    Blocks of the map are painted at the first call of `extend` that needs them; the result does not depend on
    the order.
    """

    def __init__(self, road: Road, appearance: Appearance, seed: int) -> None:
        self.road, self.appearance = road, appearance
        blocks = int(np.ceil((road.length_m + BEYOND_END_M - START_M) / (BLOCK_ROWS * CELL_M)))
        self.rows = blocks * BLOCK_ROWS
        self.map = empty_height_map(self.rows, COLUMNS)
        self.atlas, self._levels = _empty_atlas(self.rows)
        self.strip = np.zeros((COLUMNS >> LEVEL_COLUMN_SHIFTS[-1], 4), np.float32)
        self.reflects = False
        self._filled = 0
        self._edges = _carriageway(road, appearance)
        self._light = lighting.plan(appearance)
        rng = np.random.default_rng((seed, 1))
        coarse = ((self.rows + 2 * HALO_ROWS) // COARSENING, COLUMNS // COARSENING)
        self._fields = {name: fractal(rng, coarse, octaves) for name, octaves in _OCTAVES.items()}
        length = self.rows * CELL_M
        damaged = damage.plan(rng, appearance, self._edges, length)
        tired = fatigue.plan(np.random.default_rng((seed, 7)), appearance, road.features, self._edges, length)
        self._damage = replace(damaged, cracks=damaged.cracks + tired)
        marks = markings.plan(rng, appearance, self._edges, length)
        arrows = markings.plan_arrows(np.random.default_rng((seed, 8)), appearance, self._edges, length)
        self._markings = replace(marks, arrows=arrows)
        self._cover = deposits.plan(np.random.default_rng((seed, 5)), appearance, self._edges, length)
        self._paint_seeds = [(seed, 2, number) for number in range(len(road.features))]

    def extend(self, x_m: float) -> None:
        """Fill the map from its start up to `x_m`, or to its end."""
        blocks_needed = int(np.ceil((x_m - START_M) / (BLOCK_ROWS * CELL_M)))
        for index in range(self._filled, min(max(blocks_needed, 1), self.rows // BLOCK_ROWS)):
            self._fill(index)
            self._filled = index + 1
            if index == 0:
                self.strip[:] = self._levels[-1][: BLOCK_ROWS >> len(LEVEL_COLUMN_SHIFTS) - 1].mean(axis=0)

    def flat_objects(self) -> tuple[FlatObject, ...]:
        """Markings, repairs and stains of the whole road that look like obstacles."""
        return flat_objects.outlined(self._damage, self._markings, self._cover)

    def height_range(self, low_m: float, high_m: float) -> tuple[float, float]:
        """Lowest and highest height (m) of the filled map between two x."""
        first = min(max(int((low_m - START_M) / CELL_M), 0), self.rows - 1)
        last = max(int((high_m - START_M) / CELL_M), first + 1)
        part = self.map.ranges[first // MASK_CELLS : last // MASK_CELLS + 1]
        return float(part[:, 0].min()) - 1e-3, float(part[:, 1].max()) + 1e-3

    def _fill(self, index: int) -> None:
        block = self._paint(index)
        without_halo = slice(HALO_ROWS, -HALO_ROWS)
        rows = slice(index * BLOCK_ROWS, (index + 1) * BLOCK_ROWS)
        self.map.height[rows] = block.height[without_halo]
        self.map.ids[rows] = block.ids[without_halo]
        radiance = lighting.shade(self._light, block)[without_halo]
        self.reflects |= bool(radiance[..., 3].any())
        for k, (level, shift) in enumerate(zip(self._levels, LEVEL_COLUMN_SHIFTS, strict=True)):
            if k:
                radiance = cv2.resize(
                    radiance, (COLUMNS >> shift, BLOCK_ROWS >> k), interpolation=cv2.INTER_AREA
                )
            level[index * (BLOCK_ROWS >> k) : (index + 1) * (BLOCK_ROWS >> k)] = radiance
        self._update_march_mask(block, rows)

    def _paint(self, index: int) -> Block:
        block = self._empty_block(index)
        pavement.paint(block, self.appearance, self._edges)
        damage.paint(block, self._damage)
        markings.paint(block, self._markings)
        for number, (feature, seed) in enumerate(zip(self.road.features, self._paint_seeds, strict=True)):
            obstacles.paint(block, feature, number + 1, np.random.default_rng(seed), self.appearance)
        deposits.paint(block, self._cover, self.appearance, self._edges)
        pavement.apply_wetness(block, self.appearance, self._edges)
        return block

    def _empty_block(self, index: int) -> Block:
        first = index * BLOCK_ROWS - HALO_ROWS
        shape = (BLOCK_ROWS + 2 * HALO_ROWS, COLUMNS)
        x = START_M + (first + 0.5 + np.arange(shape[0]))[:, None] * CELL_M
        y = -HALF_WIDTH_M + (0.5 + np.arange(COLUMNS))[None] * CELL_M
        return Block(
            x=x,
            y=y,
            height=_heights(self.road, x, y),
            albedo=np.empty((*shape, 3), np.float32),
            ids=np.zeros(shape, np.int16),
            wet=np.zeros(shape, np.float32),
            noise={name: _upsampled_rows(field, first, shape[0]) for name, field in self._fields.items()},
        )

    def _update_march_mask(self, block: Block, rows: slice) -> None:
        """Store the height range, and the mask of fine ray steps: around features and at kerbs."""
        lateral_step = np.abs(np.diff(block.height, axis=1, prepend=block.height[:, :1]))
        uneven = (block.ids > 0) | (lateral_step > _FINE_STEP_SLOPE * CELL_M)
        tiles = uneven.reshape(-1, MASK_CELLS, COLUMNS // MASK_CELLS, MASK_CELLS).any(axis=(1, 3))
        margin = int(np.ceil(COARSE_STEP_M / (MASK_CELLS * CELL_M)))
        around = np.ones((2 * margin + 1, 2 * margin + 1), np.uint8)
        part = slice(rows.start // MASK_CELLS, rows.stop // MASK_CELLS)
        apron = HALO_ROWS // MASK_CELLS
        self.map.mask[part] = cv2.dilate(np.asarray(tiles, np.uint8), around)[apron:-apron]
        highest = cv2.dilate(block.height, np.ones((3, 3), np.uint8))[HALO_ROWS:-HALO_ROWS]
        cells = highest.reshape(-1, MASK_CELLS, COLUMNS // MASK_CELLS, MASK_CELLS)
        self.map.peaks[part] = cells.max(axis=(1, 3))
        bands = self.map.height[rows].reshape(BLOCK_ROWS // MASK_CELLS, -1)
        self.map.ranges[part] = np.stack((bands.min(axis=1), bands.max(axis=1)), axis=1)


def _empty_atlas(rows: int) -> tuple[np.ndarray, list[np.ndarray]]:
    """Empty atlas, and array views of its levels."""
    sizes = [rows >> k for k in range(len(LEVEL_COLUMN_SHIFTS))]
    atlas = np.zeros((sum(sizes), COLUMNS, 4), np.uint8)
    starts = np.cumsum([0, *sizes])
    levels = [
        atlas[start : start + size, : COLUMNS >> shift]
        for start, size, shift in zip(starts[:-1], sizes, LEVEL_COLUMN_SHIFTS, strict=True)
    ]
    return atlas, levels


def _heights(road: Road, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Road height (n, m) float32 at x (n, 1), y (1, m).

    Between features it is sampled COARSENING times more sparsely across the road and interpolated, as
    roughness itself is between its tracks.
    """
    between_features = np.ones(len(x), bool)
    for feature in road.features:
        between_features &= (x[:, 0] < feature.start_m) | (x[:, 0] > feature.end_m)
    height = np.zeros((len(x), y.shape[1]), np.float32)
    if not road.is_flat_between_features and between_features.any():
        sparse = road.height(x[between_features], y.reshape(1, -1, COARSENING).mean(axis=2)).astype(
            np.float32
        )
        height[between_features] = cv2.resize(
            sparse, (y.shape[1], len(sparse)), interpolation=cv2.INTER_LINEAR
        )
    if not between_features.all():
        height[~between_features] = road.height(x[~between_features], y)
    return height


def _upsampled_rows(field: np.ndarray, first: int, rows: int) -> np.ndarray:
    """Rows of a coarse field at the resolution of the map; `first` counts map rows from the map's start."""
    start = (first + HALO_ROWS) // COARSENING
    low, high = max(start - 2, 0), min(start + rows // COARSENING + 2, len(field))
    fine = cv2.resize(field[low:high], (COLUMNS, (high - low) * COARSENING), interpolation=cv2.INTER_LINEAR)
    return fine[(start - low) * COARSENING :][:rows]


def _carriageway(road: Road, appearance: Appearance) -> tuple[float, float]:
    """Right and left edge (m) of the carriageway: those of the appearance, widened to hold every feature."""
    right = min([appearance.right_edge_m, *(f.y_min_m - 0.05 for f in road.features)])
    left = max([appearance.left_edge_m, *(f.y_max_m + 0.05 for f in road.features)])
    return max(right, -HALF_WIDTH_M + 0.5), min(left, HALF_WIDTH_M - 0.5)
