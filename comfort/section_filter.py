"""Digital filters of second order in parallel, compiled: the signal package of SciPy is slow to import."""

from typing import Any

import numpy as np

from foreride.files.jit import njit


def in_parallel(sections: Any, samples: np.ndarray, kept: list[np.ndarray]) -> np.ndarray:
    """Sum of the responses of the sections to samples (..., n); kept: (..., 2) states of each, in place.

    sections: (b, a) of each, three coefficients, a[0] = 1 (transposed direct form II).
    """
    rows = np.ascontiguousarray(samples).reshape(-1, samples.shape[-1])
    out = np.zeros(rows.shape)
    for (b, a), states in zip(sections, kept, strict=True):
        _add_response(b, a, rows, states.reshape(-1, 2), out)
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
def _add_response(b: Any, a: Any, samples: Any, states: Any, out: Any) -> None:
    for row in range(len(samples)):
        first, second = states[row]
        for k in range(samples.shape[1]):
            value = samples[row, k]
            response = first + b[0] * value
            first = second + b[1] * value - a[1] * response
            second = b[2] * value - a[2] * response
            out[row, k] += response
        states[row, 0], states[row, 1] = first, second
