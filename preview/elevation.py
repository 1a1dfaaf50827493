"""Measured road height along an object, gathered from many frames, and what it says of a fitted shape.

The profile of an object is a template z(x) = H p((x - X) / L) on ground that may lie a little higher or
slope a little, and whose positions may all be shifted alike: what differs from frame to frame averages out,
these three do not, so they are marginalised with Gaussian priors (Schur complement).
"""

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from preview.shape import Kind, relief

Array = np.ndarray
STEP_M = 0.05
_REACH_M = 9.0  # of an object's profile, from the first sample's surroundings
_LEAST_SIGMA_M = 0.003  # of one bin, however often it was seen
_OFFSET_SIGMA_M, _SLOPE_SIGMA = 0.015, 0.005
_BLUR = np.array([-0.4, -0.2, 0.0, 0.2, 0.4])  # of a sample's smear, equal weights
_DIFFERENCE = 1e-3
_HIDDEN_WEIGHT = 0.1  # of samples just behind an obstacle, where its edge moves over the road


class Rows(NamedTuple):
    """Samples of height, arrays (n,).

    x_m: position. z_m, sigma_m: height. smear_m: length of road that each one mixes. shadow: length of road
    that an obstacle hides there, over its height.
    """

    x_m: Array
    z_m: Array
    sigma_m: Array
    smear_m: Array
    shadow: Array


@dataclass
class Elevation:
    """Weighted sums of samples in bins of `STEP_M`; x0_m: the first bin. shift_sigma_m: of all positions."""

    x0_m: float
    shift_sigma_m: float
    sums: Array = field(default_factory=lambda: np.zeros((4, round(_REACH_M / STEP_M))))

    def add(self, rows: Rows) -> None:
        """Take samples in; each is shared by the two bins beside it."""
        place = (rows.x_m - self.x0_m) / STEP_M
        low = np.floor(place).astype(int)
        weight = 1.0 / rows.sigma_m**2
        for bins, share in ((low, 1.0 - (place - low)), (low + 1, place - low)):
            inside = (bins >= 0) & (bins < self.sums.shape[1])
            w = (weight * share)[inside]
            kept = bins[inside]
            for row, value in enumerate((np.ones(len(rows.x_m)), rows.z_m, rows.smear_m, rows.shadow)):
                np.add.at(self.sums[row], kept, w * value[inside])

    def rows(self, correlation: float) -> Rows:
        """The profile so far; `correlation` inflates the variance, as errors of successive frames agree."""
        weight, z, smear, shadow = self.sums
        known = weight > 0
        x = self.x0_m + STEP_M * np.flatnonzero(known)
        w = weight[known]
        sigma = np.sqrt(correlation / w + _LEAST_SIGMA_M**2)
        return Rows(x, z[known] / w, sigma, smear[known] / w, shadow[known] / w)


def equations(kind: Kind, rows: Rows, shift_sigma_m: float, state: Array) -> tuple[Array, Array, float]:
    """Information (5, 5), gradient (5,) and half the squared error that a profile adds to a fit.

    state: [X, b, z, L, H] of `preview.fit`; pitch offset and ground height do not matter here.
    """
    model, by_x, by_length, by_height = _template(kind, rows, state)
    zero = np.zeros_like(model)
    jacobian = np.stack([by_x, zero, zero, by_length, by_height], axis=1)
    centre = state[0] + 0.5 * state[3]
    nuisance = np.stack([np.ones_like(model), rows.x_m - centre, by_x], axis=1)
    prior = np.diag([_OFFSET_SIGMA_M**-2, _SLOPE_SIGMA**-2, shift_sigma_m**-2])
    weight = 1.0 / rows.sigma_m**2
    end = state[0] + state[3]
    behind = (rows.x_m > end) & (rows.x_m < end + rows.shadow * state[4] + 0.5 * rows.smear_m)
    weight = np.where(behind & (kind.sign > 0), _HIDDEN_WEIGHT * weight, weight)
    residual = rows.z_m - model
    robust = 1.0 + (residual / (3.0 * rows.sigma_m)) ** 2
    weight = weight / robust
    own = (nuisance * weight[:, None]).T @ nuisance + prior
    cross = (nuisance * weight[:, None]).T @ jacobian
    aside = (nuisance * weight[:, None]).T @ residual
    reduce = np.linalg.solve(own, np.column_stack([cross, aside]))
    information = (jacobian * weight[:, None]).T @ jacobian - cross.T @ reduce[:, :5]
    gradient = (jacobian * weight[:, None]).T @ residual - cross.T @ reduce[:, 5]
    cost = 0.5 * (float(weight @ residual**2) - float(aside @ reduce[:, 5]))
    return information, gradient, cost


def _template(kind: Kind, rows: Rows, state: Array) -> tuple[Array, Array, Array, Array]:
    """Height (n,) of the smeared template and its derivatives by X, L and H."""

    def shape(start: float, length: float) -> Array:
        share = (rows.x_m[:, None] + rows.smear_m[:, None] * _BLUR - start) / length
        return relief(kind, np.clip(share, 0.0, 1.0), length).mean(axis=1)

    start, length, height = float(state[0]), float(state[3]), float(state[4])
    here = shape(start, length)
    by_x = (shape(start + _DIFFERENCE, length) - here) / _DIFFERENCE
    by_length = (shape(start, length + _DIFFERENCE) - here) / _DIFFERENCE
    return height * here, height * by_x, height * by_length, here
