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
        self._output = self._samples = 0.0

    def add(self, output: np.ndarray, regressors: np.ndarray) -> None:
        """Take in one sample: outputs (rows,) and regressors (models, rows, n)."""
        _add(output, regressors, self._kept, self._squares, self._products)
        self._output = self._kept * self._output + float(output @ output)
        self._samples = self._kept * self._samples + len(output)

    def fit(self) -> Fit:
        """Parameters given all data so far."""
        residual = self._residual(self._prior)
        for _ in range(2):  # the residuals decide how much the data weigh against the prior
            information = self._squares / (residual * self._correlation)[:, None, None] + self._weight
            products = self._products / (residual * self._correlation)[:, None] + self._weight @ self._prior
            parameters = np.linalg.solve(information, products[..., None])[..., 0]
            residual = self._residual(parameters)
        return Fit(
            parameters,
            np.linalg.inv(information),
            residual,
            self._samples / self._correlation,
            self._output / max(self._samples, 1.0),
        )

    def _residual(self, parameters: np.ndarray) -> np.ndarray:
        """Mean square residual of each model with these parameters, (models,)."""
        all_of = np.broadcast_to(parameters, self._products.shape)
        explained = np.einsum("mi,mij,mj->m", all_of, self._squares, all_of)
        squares = self._output - 2.0 * (self._products * all_of).sum(axis=-1) + explained
        return np.maximum(squares / max(self._samples, 1.0), self._least)


@njit
def _add(output: Any, regressors: Any, kept: float, squares: Any, products: Any) -> None:
    """Let the data so far fade to the share `kept`, and add a sample."""
    models, rows, n = regressors.shape
    for m in range(models):
        for i in range(n):
            product = 0.0
            for row in range(rows):
                product += regressors[m, row, i] * output[row]
            products[m, i] = kept * products[m, i] + product
            for j in range(n):
                square = 0.0
                for row in range(rows):
                    square += regressors[m, row, i] * regressors[m, row, j]
                squares[m, i, j] = kept * squares[m, i, j] + square
