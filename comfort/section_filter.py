"""Digital filters of second order in parallel, compiled: the signal package of SciPy is slow to import."""

from typing import Any

import numpy as np

from foreride.files.jit import njit


def in_parallel(sections: tuple[np.ndarray, np.ndarray], samples: np.ndarray, kept: np.ndarray) -> np.ndarray:
    """Sum of the responses of m sections to samples (..., n); kept: (m, ..., 2) states, in place.

    sections: numerators and denominators, (m, 3) each, the first of a denominator 1 (transposed direct form
    II).
    """
    rows = np.ascontiguousarray(samples).reshape(-1, samples.shape[-1])
    out = np.empty(rows.shape)
    _responses(*sections, rows, kept.reshape(len(kept), -1, 2), out)
    return out.reshape(samples.shape)


def moving_sum(taps: np.ndarray, samples: np.ndarray, kept: np.ndarray) -> np.ndarray:
    """Response of the taps to samples (..., n); kept: (..., taps - 1) sums begun before, in place."""
    n, rows = samples.shape[-1], samples.reshape(-1, samples.shape[-1])
    out = np.empty(rows.shape)
    for row, begun, response in zip(rows, kept.reshape(-1, len(taps) - 1), out, strict=True):
        whole = np.convolve(taps, row)
        whole[: len(begun)] += begun
        response[:], begun[:] = whole[:n], whole[n:]
    return out.reshape(samples.shape)


@njit
def _responses(b: Any, a: Any, samples: Any, states: Any, out: Any) -> None:
    """The sections go on side by side, as each sample of one waits for its last."""
    for row in range(len(samples)):
        for k in range(samples.shape[1]):
            value, total = samples[row, k], 0.0
            for i in range(len(b)):
                first, second = states[i, row]
                response = first + b[i, 0] * value
                states[i, row, 0] = second + b[i, 1] * value - a[i, 1] * response
                states[i, row, 1] = b[i, 2] * value - a[i, 2] * response
                total += response
            out[row, k] = total
