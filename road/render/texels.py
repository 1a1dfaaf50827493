"""Samples of the ground map's mip levels, four colour channels at once."""

import numpy as np

from foreride.files.jit import njit
from foreride.road.render.map_tile import LEVEL_COLUMN_SHIFTS

LEVELS = len(LEVEL_COLUMN_SHIFTS)
FULL_SCALE = 255.0 * 256.0
"""A sample's value where all texels have 255."""
_SHIFTS = np.array(LEVEL_COLUMN_SHIFTS)
_ROW_SCALES, _COLUMN_SCALES = 0.5 ** np.arange(LEVELS), 0.5**_SHIFTS
_LEAST_SHARE = 0.02
_BYTES = np.uint64(0x00FF00FF00FF00FF)


@njit(nogil=True, error_model="numpy", inline="always")
def trilinear(atlas, level, row, col):  # type: ignore[no-untyped-def]
    """Channels 0 to 3 (0..FULL_SCALE) between the two mip levels next to `level`; row, col: of the finest.

    atlas: (rows, cols) uint32, see `ground_map.Surface`, with the channels of a texel in its bytes.
    """
    k = np.uint32(level)
    share = level - k
    fine = _channels(_bilinear(atlas, k, row, col))
    if share < _LEAST_SHARE:
        return fine
    coarse = _channels(_bilinear(atlas, np.uint32(k + 1), row, col))
    return (
        fine[0] + share * (coarse[0] - fine[0]),
        fine[1] + share * (coarse[1] - fine[1]),
        fine[2] + share * (coarse[2] - fine[2]),
        fine[3] + share * (coarse[3] - fine[3]),
    )


@njit(nogil=True, error_model="numpy", inline="always")
def _bilinear(atlas, level, row, col):  # type: ignore[no-untyped-def]
    """Bilinear sample of one mip level: channels 0, 2, 1, 3 in the 16-bit lanes of an integer.

    Weights are whole 256ths, so a lane holds 256 times the mean.
    """
    # Level k has rows / 2^k rows, and all levels together 2 rows (1 - 2^-levels).
    rows = atlas.shape[0] * (1 << (LEVELS - 1)) // ((1 << LEVELS) - 1)
    level_rows, level_cols = rows >> level, atlas.shape[1] >> _SHIFTS[level]
    row = min(max(row * _ROW_SCALES[level] - 0.5, 0.0), level_rows - 1.001)
    col = min(max(col * _COLUMN_SCALES[level] - 0.5, 0.0), level_cols - 1.001)
    i, j = np.uint32(row), np.uint32(col)  # unsigned: no test for indices from the end
    down, right = int((row - i) * 256), int((col - j) * 256)
    w11 = down * right >> 8
    w10, w01 = down - w11, right - w11
    w00 = 256 - down - w01
    i += np.uint32(2 * rows - (2 * rows >> level))
    below, beside = np.uint32(i + 1), np.uint32(j + 1)
    upper = _lanes(atlas[i, j]) * np.uint64(w00) + _lanes(atlas[i, beside]) * np.uint64(w01)
    lower = _lanes(atlas[below, j]) * np.uint64(w10) + _lanes(atlas[below, beside]) * np.uint64(w11)
    return upper + lower


@njit(nogil=True, error_model="numpy", inline="always")
def _lanes(texel):  # type: ignore[no-untyped-def]
    """The four bytes of a texel, each in 16 bits: bytes 0, 2, 1, 3."""
    wide = np.uint64(texel)
    return (wide | wide << np.uint64(24)) & _BYTES


@njit(nogil=True, error_model="numpy", inline="always")
def _channels(lanes):  # type: ignore[no-untyped-def]
    """Channels 0 to 3 of a sample, 0..FULL_SCALE."""
    low, high = lanes & np.uint64(0xFFFFFFFF), lanes >> np.uint64(32)
    mask = np.uint64(0xFFFF)
    return (
        np.float64(np.int64(low & mask)),
        np.float64(np.int64(high & mask)),
        np.float64(np.int64(low >> np.uint64(16))),
        np.float64(np.int64(high >> np.uint64(16))),
    )
