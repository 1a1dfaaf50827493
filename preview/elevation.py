"""Road height measured along an object in the last frames, and what it says of a fitted shape.

A sample belongs to a line of sight: where that would meet the road plane, and how high over the plane it
ended instead. A shape z(x) = H p((x - X) / L) is seen where the line meets it first, so crests hide what is
behind them and rims the floor of holes. What spoils many samples alike is marginalised with Gaussian priors
(Schur complement): the plane that a frame found may lie a little off and slope a little; ground at the object
may do so in all frames; a table's ramps may be of another length; and all positions may be shifted alike.
"""

from collections import deque
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from preview.shape import RAMP, TABLE, Kind, relief

Array = np.ndarray
_FRAMES = 8
_CORRELATION = 1.5  # inflation of variance: windows overlap, and frames see the same texture
_LEAST_SIGMA_M = 0.003
_FRAME_OFFSET_SIGMA_M, _FRAME_SLOPE_SIGMA = 0.008, 0.008
_OFFSET_SIGMA_M, _SLOPE_SIGMA = 0.015, 0.005
_RAMP_SIGMA = 0.018  # of a table's ramps, as a share of its length
_ROBUST = 3.0  # standard deviations of a sample that counts half
_SILHOUETTE = 3.0  # of what lies before and behind a crest windows show one more than the other
_SHARE = np.linspace(0.0, 1.0, 25)
_BLUR = np.array([-0.33, 0.0, 0.33])  # of a sample's smear
_STEP = np.array([0.01, 0.01, 0.002, 0.01])  # of central differences by X, L, H, ramp: over what lines jump
_STEPS = np.concatenate([np.zeros((1, 4)), np.kron(np.diag(_STEP), [[1.0], [-1.0]])])
_SHARED, _FRAME = slice(6, 10), slice(10, 12)  # columns of a table that are marginalised


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


class NearEdge(NamedTuple):
    """Where the bottom edge of a box meets the plane that its frame found.

    x_m, sigma_m: place; low_m: how much farther it is for each rad that the detector draws edges too low.
    """

    x_m: float
    sigma_m: float
    low_m: float


@dataclass
class Elevation:
    """The samples of the newest frames.

    shift_sigma_m: standard deviation of what shifts all positions. absolute: they rest on triangulation, not
    on the plane under the wheels.
    """

    shift_sigma_m: float
    absolute: bool = True
    frames: deque[Rows] = field(default_factory=lambda: deque(maxlen=_FRAMES))
    edges: deque[NearEdge] = field(default_factory=lambda: deque(maxlen=_FRAMES))

    def add(self, rows: Rows, edge: NearEdge | None = None) -> None:
        """Take a frame in, its variance inflated."""
        sigma = np.sqrt(_CORRELATION * (rows.sigma_m**2 + _LEAST_SIGMA_M**2))
        self.frames.append(rows._replace(sigma_m=sigma))
        if edge is not None:
            self.edges.append(edge)


def equations(kind: Kind, elevation: Elevation, state: Array) -> tuple[Array, Array, float]:
    """Information (6, 6), gradient (6,) and half the squared error that samples add to a fit.

    state: [X, b, z, L, H, d] of `preview.fit`; b and z do not matter here.
    """
    rows = Rows(*(np.concatenate(parts) for parts in zip(*elevation.frames, strict=True)))
    shape = np.array([state[0], state[3], state[4], RAMP])
    steps = _STEPS if kind is TABLE else _STEPS[:-2]  # the others have no ramps
    mixed = _mixed(kind, rows, shape + steps)
    levels = mixed.mean(axis=2)
    model = levels[0]
    slopes = (levels[1::2] - levels[2::2]) / (2.0 * _STEP[: len(steps) // 2, None])
    by_x, by_length, by_height = slopes[:3]
    by_ramp = slopes[3] if kind is TABLE else np.zeros_like(model)
    one, zero, behind = np.ones_like(model), np.zeros_like(model), rows.x_m - state[0] - 0.5 * state[3]
    residual = rows.z_m - model
    # The state; what is marginalised: ground, slope, shift, ramp, a frame's ground and slope; what is left.
    columns = [
        by_x,
        zero,
        zero,
        by_length,
        by_height,
        zero,
        one,
        behind,
        by_x,
        by_ramp,
        one,
        behind,
        residual,
    ]
    table = np.stack(columns, axis=1)
    sigma = np.hypot(rows.sigma_m, _SILHOUETTE * np.abs(mixed[0, :, 1] - model))
    weight = sigma**-2 / (1.0 + (residual / (_ROBUST * sigma)) ** 2)
    ends = np.cumsum([len(frame.x_m) for frame in elevation.frames])[:-1]
    squares = [
        _without((part * heavy[:, None]).T @ part, _FRAME, (_FRAME_OFFSET_SIGMA_M, _FRAME_SLOPE_SIGMA))
        for part, heavy in zip(np.split(table, ends), np.split(weight, ends), strict=True)
    ]
    squares += [_edge_terms(edge, state) for edge in elevation.edges]
    shared = (_OFFSET_SIGMA_M, _SLOPE_SIGMA, elevation.shift_sigma_m, _RAMP_SIGMA)
    total = _without(np.sum(squares, axis=0), _SHARED, shared)
    return total[:6, :6], total[:6, 6], 0.5 * float(total[6, 6]) + float(np.log(sigma / rows.sigma_m).sum())


def _edge_terms(edge: NearEdge, state: Array) -> Array:
    """What one edge adds to the table's square (11, 11): its distance from X, shift and low rows apart."""
    residual = edge.x_m + edge.low_m * state[5] - state[0]
    weight = edge.sigma_m**-2 / (1.0 + (residual / (_ROBUST * edge.sigma_m)) ** 2)
    line = np.array([1.0, 0.0, 0.0, 0.0, 0.0, -edge.low_m, 0.0, 0.0, 1.0, 0.0, residual])
    return weight * np.outer(line, line)


def _without(square: Array, aside: slice, sigmas: tuple[float, ...]) -> Array:
    """The square of a table with the columns `aside` marginalised; `sigmas` are of their prior."""
    own = square[aside, aside] + np.diag(np.array(sigmas) ** -2.0)
    rest = np.delete(np.arange(len(square)), aside)
    cross = square[aside][:, rest]
    return square[np.ix_(rest, rest)] - cross.T @ np.linalg.solve(own, cross)


def seen(
    kind: Kind, rows: Rows, start_m: float, length_m: float, height_m: float, ramp: float = RAMP
) -> Array:
    """Height (n,) at which each line of sight meets the shape first, mixed over the smear; 0 beside it."""
    return _mixed(kind, rows, np.array([[start_m, length_m, height_m, ramp]]))[0].mean(axis=1)


def _mixed(kind: Kind, rows: Rows, shapes: Array) -> Array:
    """The three heights (shapes, n, 3) near, amid and far in the smear that `seen` mixes.

    shapes: (shapes, 4) near edge, length, height, and the share of a ramp.
    """
    start, length, height, ramp = shapes.T[:, :, None]
    along = start + _SHARE * length
    rises = height * relief(kind, _SHARE, length, ramp)
    # The line through a point of the shape meets the plane there; hidden points do not advance it.
    meets = np.maximum.accumulate(along[:, None, :] + rises[:, None, :] * rows.slant[:, None], axis=2)
    wanted = rows.x_m[:, None] + rows.smear_m[:, None] * _BLUR
    after = (meets[:, :, None, :] < wanted[:, :, None]).sum(axis=3)
    inside = (after > 0) & (after < len(_SHARE))
    k = np.clip(after, 1, len(_SHARE) - 1)
    low, high = np.take_along_axis(meets, k - 1, axis=2), np.take_along_axis(meets, k, axis=2)
    # Over a hidden stretch the height jumps: the point where the line emerges counts.
    part = np.clip((wanted - low) / np.maximum(high - low, 1e-9), 0.0, 1.0)
    number = np.arange(len(shapes))[:, None, None]
    before = rises[number, k - 1]
    return np.where(inside, before + part * (rises[number, k] - before), 0.0)
