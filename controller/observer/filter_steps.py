"""Steps of a Kalman filter in compiled loops, which skip the zeros of the model's sparse matrices."""

from typing import Any

import numpy as np

from foreride.files.jit import njit


@njit
def propagated(covariance: Any, matrix: Any, inputs: Any, variance: Any) -> Any:
    """M P Mᵀ + B diag(v) Bᵀ of the transition M (n, n) and the inputs B (n, m), symmetric to the last bit."""
    n = len(covariance)
    half, out = np.zeros((n, n)), np.zeros((n, n))
    for i in range(n):
        for k in range(n):
            factor = matrix[i, k]
            if factor != 0.0:
                for j in range(n):
                    half[j, i] += factor * covariance[k, j]
    for i in range(n):
        for k in range(n):
            factor = matrix[i, k]
            if factor != 0.0:
                for j in range(i + 1):
                    out[i, j] += factor * half[k, j]
        for m in range(len(variance)):
            if inputs[i, m] != 0.0:
                factor = inputs[i, m] * variance[m]
                for j in range(i + 1):
                    out[i, j] += factor * inputs[j, m]
        for j in range(i):
            out[j, i] = out[i, j]
    return out


@njit
def product(matrix: Any, vector: Any) -> Any:
    """Matrix times vector."""
    out = np.zeros(len(matrix))
    for i in range(len(matrix)):
        for j in range(len(vector)):
            out[i] += matrix[i, j] * vector[j]
    return out


@njit
def taken_in(state: Any, covariance: Any, output: Any, innovation: Any, variance: Any) -> Any:
    """State and covariance after readings of independent errors, one after the other.

    output: (m, n). innovation: (m,) readings less those expected of `state`. variance: (m,) of their errors.
    """
    n = len(state)
    change, covariance = np.zeros(n), covariance.copy()
    cross = np.empty(n)
    for m in range(len(innovation)):
        row, rest = output[m], innovation[m]
        cross[:] = 0.0
        for k in range(n):
            if row[k] != 0.0:
                rest -= row[k] * change[k]
                for j in range(n):
                    cross[j] += row[k] * covariance[k, j]
        expected = variance[m]
        for k in range(n):
            expected += row[k] * cross[k]
        for i in range(n):
            change[i] += cross[i] * (rest / expected)
        cross /= np.sqrt(expected)
        for i in range(n):
            for j in range(n):
                covariance[i, j] -= cross[i] * cross[j]
    return state + change, covariance


@njit
def expected_covariance(covariance: Any, output: Any, variance: Any) -> Any:
    """Covariance H P Hᵀ + diag(v) of the innovation of readings taken at once."""
    count, n = output.shape
    out, cross = np.empty((count, count)), np.empty(n)
    for i in range(count):
        cross[:] = 0.0
        for k in range(n):
            if output[i, k] != 0.0:
                for j in range(n):
                    cross[j] += output[i, k] * covariance[k, j]
        for j in range(i + 1):
            total = variance[i] if i == j else 0.0
            for k in range(n):
                total += output[j, k] * cross[k]
            out[i, j] = out[j, i] = total
    return out


@njit
def predicted(
    state: Any, covariance: Any, samples: Any, variance: Any, aliasing: Any, transition: Any, drive: Any
) -> Any:
    """State and covariance one period on.

    samples: (3, m) accelerations of the period's end, of its beginning and one period before. aliasing:
    standard deviation of the period's mean acceleration per second difference of them.
    """
    now, previous, before = samples
    mean = (5.0 * now + 8.0 * previous - before) / 12.0
    unseen = aliasing * (now - 2.0 * previous + before)
    moved = product(transition, state) + product(drive, mean)
    return moved, propagated(covariance, transition, drive, variance + unseen**2)


@njit
def corrected(state: Any, covariance: Any, output: Any, reading: Any, variance: Any) -> Any:
    """State and covariance after a reading, its innovation and that one's covariance."""
    innovation = reading - product(output, state)
    expected = expected_covariance(covariance, output, variance)
    state, covariance = taken_in(state, covariance, output, innovation, variance)
    return state, covariance, innovation, expected
