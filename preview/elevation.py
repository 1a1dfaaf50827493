"""Road height measured along an object in the last frames, and what it says of a fitted shape.

A sample belongs to a line of sight: where that would meet the road plane, and how high over the plane it
ended instead. A shape z(x) = H p((x - X) / L) is seen where the line meets it first, so crests hide what is
behind them and rims the floor of holes. Ground at the object may lie a little higher or slope a little, and
all positions may be shifted alike: what differs from frame to frame averages out, these three do not, so they
are marginalised with Gaussian priors (Schur complement).
"""

from collections import deque
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from preview.shape import Kind, relief

Array = np.ndarray
_FRAMES = 8
_CORRELATION = 1.5  # inflation of variance: windows overlap, and frames see the same texture
_LEAST_SIGMA_M = 0.003
_OFFSET_SIGMA_M, _SLOPE_SIGMA = 0.015, 0.005
_ROBUST = 3.0  # standard deviations of a sample that counts half
_SHARE = np.linspace(0.0, 1.0, 25)
_BLUR = np.array([-0.33, 0.0, 0.33])  # of a sample's smear
_STEP = np.array([0.01, 0.01, 0.002])  # of central differences by X, L and H: over what lines jump


class Rows(NamedTuple):
    """Samples of height, arrays (n,).

    x_m: where the line of sight meets the plane. z_m, sigma_m: height over the plane at which it ends.
    smear_m: length of road that the sample mixes. slant: how far the line goes forward for a metre of fall.
    """

    x_m: Array
    z_m: Array
    sigma_m: Array
    smear_m: Array
    slant: Array


@dataclass
class Elevation:
    """The samples of the newest frames.

    shift_sigma_m: standard deviation of what shifts all positions. absolute: they rest on triangulation, not
    on the plane under the wheels.
    """

    shift_sigma_m: float
    absolute: bool = True
    frames: deque[Rows] = field(default_factory=lambda: deque(maxlen=_FRAMES))

    def rows(self) -> Rows:
        """All samples, their variance inflated."""
        joined = Rows(*(np.concatenate(parts) for parts in zip(*self.frames, strict=True)))
        sigma = np.sqrt(_CORRELATION * (joined.sigma_m**2 + _LEAST_SIGMA_M**2))
        return joined._replace(sigma_m=sigma)


def equations(kind: Kind, rows: Rows, shift_sigma_m: float, state: Array) -> tuple[Array, Array, float]:
    """Information (6, 6), gradient (6,) and half the squared error that samples add to a fit.

    state: [X, b, z, L, H, d] of `preview.fit`; b, z and d do not matter here.
    """
    shape = np.array([state[0], state[3], state[4]])
    model = seen(kind, rows, *shape)
    by_x, by_length, by_height = (
        (seen(kind, rows, *(shape + step)) - seen(kind, rows, *(shape - step))) / (2.0 * step.max())
        for step in np.diag(_STEP)
    )
    zero = np.zeros_like(model)
    jacobian = np.stack([by_x, zero, zero, by_length, by_height, zero], axis=1)
    centre = state[0] + 0.5 * state[3]
    nuisance = np.stack([np.ones_like(model), rows.x_m - centre, by_x], axis=1)
    prior = np.diag([_OFFSET_SIGMA_M**-2, _SLOPE_SIGMA**-2, shift_sigma_m**-2])
    residual = rows.z_m - model
    weight = rows.sigma_m**-2 / (1.0 + (residual / (_ROBUST * rows.sigma_m)) ** 2)
    own = (nuisance * weight[:, None]).T @ nuisance + prior
    cross = (nuisance * weight[:, None]).T @ jacobian
    aside = (nuisance * weight[:, None]).T @ residual
    solved = np.linalg.solve(own, np.column_stack([cross, aside]))
    information = (jacobian * weight[:, None]).T @ jacobian - cross.T @ solved[:, :-1]
    gradient = (jacobian * weight[:, None]).T @ residual - cross.T @ solved[:, -1]
    cost = 0.5 * (float(weight @ residual**2) - float(aside @ solved[:, -1]))
    return information, gradient, cost


def seen(kind: Kind, rows: Rows, start_m: float, length_m: float, height_m: float) -> Array:
    """Height (n,) at which each line of sight meets the shape first, mixed over the smear; 0 beside it."""
    along = start_m + _SHARE * length_m
    height = height_m * relief(kind, _SHARE, length_m)
    # The line through a point of the shape meets the plane there; hidden points do not advance it.
    meets = np.maximum.accumulate(along + height * rows.slant[:, None], axis=1)
    wanted = rows.x_m[:, None] + rows.smear_m[:, None] * _BLUR
    after = (meets[:, None, :] < wanted[:, :, None]).sum(axis=2)
    inside = (after > 0) & (after < len(_SHARE))
    k = np.clip(after, 1, len(_SHARE) - 1)
    low, high = np.take_along_axis(meets, k - 1, axis=1), np.take_along_axis(meets, k, axis=1)
    # Over a hidden stretch the height jumps: the point where the line emerges counts.
    part = np.clip((wanted - low) / np.maximum(high - low, 1e-9), 0.0, 1.0)
    value = height[k - 1] + part * (height[k] - height[k - 1])
    return np.where(inside, value, 0.0).mean(axis=1)
