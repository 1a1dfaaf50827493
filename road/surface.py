"""The lit map of a road: height, object ids and radiance on a 2 cm grid, filled as the camera advances."""

from dataclasses import dataclass

import cv2
import numpy as np

from road import damage, feature_paint, lighting, markings, pavement
from road.appearance import Appearance
from road.profile import Road
from road.texture import fractal

CELL_M = 0.02
HALF_WIDTH_M = 8.0
COLUMNS = int(2 * HALF_WIDTH_M / CELL_M)
BLOCK_ROWS = 640
APRON_ROWS = 40  # shadows and shading look this far past a block
COARSE = 4  # the smooth random fields live on a grid this much coarser
START_M = -2.0
BEYOND_END_M = 50.0  # the map goes on past the road's end so that the view never stops
# One mip level halves the rows; columns halve more rarely because a grazing view shrinks lengths along
# the road by distance/height more than widths.
COLUMN_SHIFTS = (0, 0, 0, 0, 1, 1, 2)
MASK_CELLS = 10  # one cell of the march mask covers this many map cells each way


@dataclass
class Block:
    """A stretch of road being painted: `x` (n, 1) and `y` (1, m) cell centres, fields (n, m) or (n, m, 3)."""

    x: np.ndarray
    y: np.ndarray
    height: np.ndarray
    albedo: np.ndarray
    ids: np.ndarray
    wet: np.ndarray
    noise: dict[str, np.ndarray]


class Surface:
    """Maps of one scene. `extend(x)` makes sure that they are filled up to x; order of calls is immaterial.

    height (rows, cols) float32 metres; ids (rows, cols) int16, 0 none, k feature k-1; textures: mip levels
    (rows, cols, 4) uint8 of sqrt-encoded radiance (see lighting.WHITE) and wetness; mask (rows, cols)/10 uint8,
    1 near features, where a view ray has to be marched finely.
    """

    def __init__(self, road: Road, look: Appearance, seed: int) -> None:
        self.road, self.look = road, look
        blocks = int(np.ceil((road.length_m + BEYOND_END_M - START_M) / (BLOCK_ROWS * CELL_M)))
        self.rows = blocks * BLOCK_ROWS
        self.height = np.zeros((self.rows, COLUMNS), np.float32)
        self.ids = np.zeros((self.rows, COLUMNS), np.int16)
        self.textures = tuple(
            np.zeros((self.rows >> k, COLUMNS >> s, 4), np.uint8) for k, s in enumerate(COLUMN_SHIFTS)
        )
        self.mask = np.zeros((self.rows // MASK_CELLS, COLUMNS // MASK_CELLS), np.uint8)
        self.strip = np.zeros((COLUMNS >> COLUMN_SHIFTS[-1], 4), np.float32)
        self._filled = np.zeros(blocks, bool)
        rng = np.random.default_rng((seed, 1))
        self._edges = _carriageway(road, look)
        self._fields = self._smooth_fields(rng)
        self._light = lighting.plan(look)
        length = self.rows * CELL_M
        self._damage = damage.plan(rng, look, self._edges, length)
        self._markings = markings.plan(rng, look, self._edges, length)
        self._paints = [np.random.default_rng((seed, 2, k)).integers(2**63) for k in range(len(road.features))]

    def extend(self, x_m: float) -> None:
        """Fill every block from the start of the map to `x_m`."""
        last = int(np.clip((x_m - START_M) / (BLOCK_ROWS * CELL_M), 0, len(self._filled) - 1))
        for index in np.flatnonzero(~self._filled[: last + 1]):
            self._fill(int(index))
        if not self.strip.any():
            self.strip[:] = self.textures[-1][: BLOCK_ROWS >> (len(COLUMN_SHIFTS) - 1)].mean(axis=0)

    def _smooth_fields(self, rng: np.random.Generator) -> dict[str, np.ndarray]:
        shape = ((self.rows + 2 * APRON_ROWS) // COARSE, COLUMNS // COARSE)
        return {
            "tone": fractal(rng, shape, (0.05, 0.05, 0.04, 0.04, 0.03, 0.03, 0.03)),
            "wear": fractal(rng, shape, (0.1, 0.15, 0.2, 0.3, 0.35)),
            "dirt": fractal(rng, shape, (0.3, 0.3, 0.25, 0.2, 0.15, 0.1)),
            "foliage": fractal(rng, shape, (0.6, 0.5, 0.4, 0.35, 0.25)),
        }

    def _fill(self, index: int) -> None:
        block = self._paint(index)
        radiance = lighting.shade(self._light, block, CELL_M)
        inner = slice(APRON_ROWS, -APRON_ROWS)
        rows = slice(index * BLOCK_ROWS, (index + 1) * BLOCK_ROWS)
        self.height[rows] = block.height[inner]
        self.ids[rows] = block.ids[inner]
        level = np.dstack((lighting.encode(radiance[inner]), np.rint(255 * np.clip(block.wet[inner], 0, 1))))
        level = level.astype(np.uint8)
        for k, shift in enumerate(COLUMN_SHIFTS):
            if k:
                size = (COLUMNS >> shift, BLOCK_ROWS >> k)
                level = cv2.resize(level, size, interpolation=cv2.INTER_AREA)
            self.textures[k][index * (BLOCK_ROWS >> k) : (index + 1) * (BLOCK_ROWS >> k)] = level
        self._mark(index)
        self._filled[index] = True

    def _paint(self, index: int) -> Block:
        first = index * BLOCK_ROWS - APRON_ROWS
        rows = BLOCK_ROWS + 2 * APRON_ROWS
        x = START_M + (first + 0.5 + np.arange(rows))[:, None] * CELL_M
        y = -HALF_WIDTH_M + (0.5 + np.arange(COLUMNS))[None] * CELL_M
        noise = {name: self._noise(field, first, rows) for name, field in self._fields.items()}
        shape = (rows, COLUMNS)
        block = Block(
            x=x,
            y=y,
            height=np.asarray(self.road.height(x, y), np.float32).copy(),
            albedo=np.empty((*shape, 3), np.float32),
            ids=np.zeros(shape, np.int16),
            wet=np.zeros(shape, np.float32),
            noise=noise,
        )
        pavement.paint(block, self.look, self._edges)
        damage.paint(block, self._damage)
        markings.paint(block, self._markings)
        for number, feature in enumerate(self.road.features):
            if feature.start_m < x[-1, 0] and feature.start_m + feature.length_m > x[0, 0]:
                feature_paint.paint(block, feature, number + 1, int(self._paints[number]), self.look)
        pavement.soak(block, self.look, self._edges)
        return block

    def _noise(self, field: np.ndarray, first: int, rows: int) -> np.ndarray:
        start = (first + APRON_ROWS) // COARSE
        low, high = max(start - 2, 0), min(start + rows // COARSE + 2, len(field))
        fine = cv2.resize(field[low:high], (COLUMNS, (high - low) * COARSE), interpolation=cv2.INTER_LINEAR)
        skip = (start - low) * COARSE
        return fine[skip : skip + rows]

    def _mark(self, index: int) -> None:
        """Have the march look closely where features are and where the height jumps (kerbs)."""
        per_block = BLOCK_ROWS // MASK_CELLS
        ids = self.ids[index * BLOCK_ROWS : (index + 1) * BLOCK_ROWS]
        height = self.height[index * BLOCK_ROWS : (index + 1) * BLOCK_ROWS]
        uneven = (ids > 0) | (np.abs(np.diff(height, axis=1, prepend=height[:, :1])) > 0.3 * CELL_M)
        tiles = uneven.reshape(per_block, MASK_CELLS, -1, MASK_CELLS).any(axis=(1, 3))
        low, high = index * per_block, (index + 1) * per_block
        self.mask[low:high] |= tiles.astype(np.uint8)
        grown = cv2.dilate(tiles.astype(np.uint8), np.ones((3, 3), np.uint8))
        self.mask[low:high] |= grown


def _carriageway(road: Road, look: Appearance) -> tuple[float, float]:
    """Right and left edge (m) of the carriageway: as the look says, but wide enough for every feature."""
    right = min([look.right_edge_m, *(f.y_min_m - 0.05 for f in road.features)])
    left = max([look.left_edge_m, *(f.y_max_m + 0.05 for f in road.features)])
    return max(right, -HALF_WIDTH_M + 0.5), min(left, HALF_WIDTH_M - 0.5)
