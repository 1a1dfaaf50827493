"""Recursive least squares for a bank of models, with a prior that remains and forgetting of the data alone.

Each model of the bank explains the same output y by regressors of its own, y = regressors · theta + e. Data
fade with the memory's time constant, the prior does not, so that parameters which nothing excites return to
it instead of drifting (stabilised forgetting: R. Kulhavý & M. B. Zarrop, On a general concept of forgetting,
Int. J. Control 58(4), 1993). The variance of e is that of the residuals. As they are correlated in time, they
count as one independent residual for each correlation time.
"""

from typing import Any, NamedTuple

import numpy as np

from foreride.files.jit import njit


class Fit(NamedTuple):
    """Parameters of each model (models, n), their covariance (models, n, n), and mean square residual.

    residual: (models,). independent: number of independent residuals. output: mean square of the output.
    """

    parameters: np.ndarray
    covariance: np.ndarray
    residual: np.ndarray
    independent: float
    output: float


class LeastSquaresBank:
    """Bank of `models` with parameters around `prior` (n,), each with the standard deviation `prior_sigma`.

    memory: samples after which data have faded to 1/e. correlation: samples for each independent residual.
    least_sigma: least standard deviation of a residual.
    """

    def __init__(
        self,
        models: int,
        prior: np.ndarray,
        prior_sigma: float,
        memory: float,
        correlation: float,
        least_sigma: float,
    ) -> None:
        self._models, self._prior, self._weight = models, prior, np.eye(len(prior)) / prior_sigma**2
        self._kept, self._correlation, self._least = np.exp(-1.0 / memory), correlation, least_sigma**2
        self.reset()

    def reset(self) -> None:
        """Forget all data."""
        n = len(self._prior)
        self._squares, self._products = np.zeros((self._models, n, n)), np.zeros((self._models, n))
        self._sums = np.zeros(2)

    def add(self, outputs: np.ndarray, regressors: np.ndarray) -> None:
        """Take in samples in turn: outputs (samples, rows), regressors (samples, models, rows, n)."""
        _add(outputs, regressors, self._kept, self._squares, self._products, self._sums)

    def fit(self) -> Fit:
        """Parameters given all data so far."""
        data, known = (self._squares, self._products, self._sums), (self._prior, self._weight)
        parameters, covariance, residual = _fitted(*data, *known, self._correlation, self._least)
        output, samples = self._sums.tolist()
        independent = samples / self._correlation
        return Fit(parameters, covariance, residual, independent, output / max(samples, 1.0))


@njit
def _fitted(
    squares: Any, products: Any, sums: Any, prior: Any, weight: Any, correlation: float, least: float
) -> Any:
    """Parameters (models, n), their covariance and the mean square residuals (models,)."""
    models, n = products.shape
    parameters, covariance, residuals = np.empty((models, n)), np.empty((models, n, n)), np.empty(models)
    by_prior = np.dot(weight, prior)
    for m in range(models):
        own, spread = parameters[m], covariance[m]
        data = squares[m], products[m], sums, least
        residuals[m] = _residual(prior, *data)
        for _ in range(2):  # the residuals decide how much the data weigh against the prior
            share = 1.0 / (residuals[m] * correlation)
            for i in range(n):
                for j in range(n):
                    spread[i, j] = squares[m, i, j] * share + weight[i, j]
            _invert(spread)
            for i in range(n):
                own[i] = 0.0
                for j in range(n):
                    own[i] += spread[i, j] * (products[m, j] * share + by_prior[j])
            residuals[m] = _residual(own, *data)
    return parameters, covariance, residuals


@njit
def _invert(matrix: Any) -> None:
    """Replace a symmetric positive definite matrix by its inverse: Gauss–Jordan, pivots on the diagonal."""
    n = len(matrix)
    for k in range(n):
        pivot = matrix[k, k]
        matrix[k, k] = 1.0
        for j in range(n):
            matrix[k, j] /= pivot
        for i in range(n):
            if i != k:
                factor = matrix[i, k]
                matrix[i, k] = 0.0
                for j in range(n):
                    matrix[i, j] -= factor * matrix[k, j]


@njit
def _residual(parameters: Any, squares: Any, products: Any, sums: Any, least: float) -> float:
    """Mean square residual of a model with these parameters."""
    total = sums[0]
    for i in range(len(parameters)):
        total -= 2.0 * products[i] * parameters[i]
        for j in range(len(parameters)):
            total += parameters[i] * squares[i, j] * parameters[j]
    return max(total / max(sums[1], 1.0), least)


@njit
def _add(outputs: Any, regressors: Any, kept: float, squares: Any, products: Any, sums: Any) -> None:
    """Let the data so far fade to the share `kept`, and add a sample, one after the other.

    sums: of the squared outputs and of the rows, both faded.
    """
    samples, models, rows, n = regressors.shape
    for k in range(samples):
        output = outputs[k]
        sums[0] *= kept
        for row in range(rows):
            sums[0] += output[row] * output[row]
        sums[1] = kept * sums[1] + rows
        for m in range(models):
            for i in range(n):
                product = 0.0
                for row in range(rows):
                    product += regressors[k, m, row, i] * output[row]
                products[m, i] = kept * products[m, i] + product
                for j in range(n):
                    square = 0.0
                    for row in range(rows):
                        square += regressors[k, m, row, i] * regressors[k, m, row, j]
                    squares[m, i, j] = kept * squares[m, i, j] + square
