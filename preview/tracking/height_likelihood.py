"""Height-profile likelihood: height samples of the last frames and their normal equations for a shape.

A sample belongs to a line of sight: the point where it would meet the road plane, and the height over the
plane at which it ended instead. A shape z(x) = H p((x - X) / L) is seen where the line meets it first, so
crests hide the road behind them and rims the floor of holes. Errors common to many samples are marginalised
with Gaussian priors (Schur complement): offset and slope of the plane that a frame found; offset and slope of
the ground at the object in all frames; the ramp length of a table; and a common shift of all positions.
"""

from collections import deque
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from foreride.preview.obstacle_classes import ObstacleTemplate
from foreride.preview.tracking.object_state import EDGE_BIAS, HEIGHT, LENGTH, X
from foreride.preview.tracking.obstacle_templates import ramp_share, unit_profile

Array = np.ndarray
_FRAMES = 8
_CORRELATION = 1.5  # variance inflation: windows overlap, and frames see the same texture
_MIN_SIGMA_M = 0.003
_FRAME_OFFSET_SIGMA_M, _FRAME_SLOPE_SIGMA = 0.008, 0.008
_OFFSET_SIGMA_M, _SLOPE_SIGMA = 0.015, 0.005
_RAMP_SIGMA = 0.06  # sigma of a table's ramp length, as a share of its length
_ROBUST = 3.0  # residual in standard deviations with half weight
_CREST_SIGMA_RATIO = (
    3.0  # sigma at a crest, over the spread within the smear: windows are biased to one side of it
)
_PROFILE_POINTS = np.linspace(0.0, 1.0, 25)
_SMEAR_POINTS = np.array([-0.33, 0.0, 0.33])  # positions within a sample's smear
_STEP = np.array([0.01, 0.01, 0.002, 0.01])  # by X, L, H, ramp: wide enough to bridge jumps
_STEPS = np.concatenate([np.zeros((1, 4)), np.kron(np.diag(_STEP), [[1.0], [-1.0]])])
_SHARED, _FRAME = slice(6, 10), slice(10, 12)  # marginalised columns of a table


class HeightRows(NamedTuple):
    """Height samples, arrays (n,).

    x_m: intersection of the line of sight with the plane. z_m, sigma_m: height over the plane at which it
    ends. smear_m: length of road averaged by the sample. slant: forward run of the line of sight per metre of
    fall.
    """

    x_m: Array
    z_m: Array
    sigma_m: Array
    smear_m: Array
    slant: Array


class NearEdge(NamedTuple):
    """Intersection of a box's bottom edge with the plane that its frame found.

    x_m, sigma_m: position; low_m: change of position per rad of bottom-edge bias.
    """

    x_m: float
    sigma_m: float
    low_m: float


@dataclass
class HeightSamples:
    """Height samples of the newest frames.

    shift_sigma_m: standard deviation of the common shift of all positions. absolute: True if positions are
    triangulated (stereo), False if they rest on the plane under the wheels.
    """

    shift_sigma_m: float
    absolute: bool = True
    frames: deque[HeightRows] = field(default_factory=lambda: deque(maxlen=_FRAMES))
    edges: deque[NearEdge] = field(default_factory=lambda: deque(maxlen=_FRAMES))

    def add(self, rows: HeightRows, edge: NearEdge | None = None) -> None:
        """Add a frame, its variance inflated."""
        sigma = np.sqrt(_CORRELATION * (rows.sigma_m**2 + _MIN_SIGMA_M**2))
        self.frames.append(rows._replace(sigma_m=sigma))
        if edge is not None:
            self.edges.append(edge)


def equations(kind: ObstacleTemplate, elevation: HeightSamples, state: Array) -> tuple[Array, Array, float]:
    """Information (6, 6), gradient (6,) and half the squared error of the samples, to be added to a fit.

    state: indices of `preview.tracking.object_state`; pitch offset and ground height do not matter here.
    """
    rows = HeightRows(*(np.concatenate(parts) for parts in zip(*elevation.frames, strict=True)))
    shape = np.array([state[X], state[LENGTH], state[HEIGHT], float(ramp_share(kind, state[LENGTH]))])
    steps = _STEPS if kind.ramp_m else _STEPS[:-2]  # other kinds have no ramps
    smeared = _smeared_heights(kind, rows, shape + steps)
    levels = smeared.mean(axis=2)
    model = levels[0]
    slopes = (levels[1::2] - levels[2::2]) / (2.0 * _STEP[: len(steps) // 2, None])
    by_x, by_length, by_height = slopes[:3]
    by_ramp = slopes[3] if kind.ramp_m else np.zeros_like(model)
    ones, zeros, from_middle = (
        np.ones_like(model),
        np.zeros_like(model),
        rows.x_m - state[X] - 0.5 * state[LENGTH],
    )
    residual = rows.z_m - model
    # State; nuisances (ground, slope, shift, ramp, a frame's ground and slope); residual.
    columns = [
        by_x,
        zeros,
        zeros,
        by_length,
        by_height,
        zeros,
        ones,
        from_middle,
        by_x,
        by_ramp,
        ones,
        from_middle,
        residual,
    ]
    table = np.stack(columns, axis=1)
    sigma = np.hypot(rows.sigma_m, _CREST_SIGMA_RATIO * np.abs(smeared[0, :, 1] - model))
    weight = sigma**-2 / (1.0 + (residual / (_ROBUST * sigma)) ** 2)
    ends = np.cumsum([len(frame.x_m) for frame in elevation.frames])[:-1]
    squares = [
        _marginalise(
            (part * frame_weight[:, None]).T @ part, _FRAME, (_FRAME_OFFSET_SIGMA_M, _FRAME_SLOPE_SIGMA)
        )
        for part, frame_weight in zip(np.split(table, ends), np.split(weight, ends), strict=True)
    ]
    squares += [_edge_terms(edge, state) for edge in elevation.edges]
    shared = (_OFFSET_SIGMA_M, _SLOPE_SIGMA, elevation.shift_sigma_m, _RAMP_SIGMA)
    total = _marginalise(np.sum(squares, axis=0), _SHARED, shared)
    return total[:6, :6], total[:6, 6], 0.5 * float(total[6, 6]) + float(np.log(sigma / rows.sigma_m).sum())


def _edge_terms(edge: NearEdge, state: Array) -> Array:
    """Contribution of one near edge to the table's square (11, 11): distance from X, shift, edge bias."""
    residual = edge.x_m + edge.low_m * state[EDGE_BIAS] - state[X]
    weight = edge.sigma_m**-2 / (1.0 + (residual / (_ROBUST * edge.sigma_m)) ** 2)
    row = np.array([1.0, 0.0, 0.0, 0.0, 0.0, -edge.low_m, 0.0, 0.0, 1.0, 0.0, residual])
    return weight * np.outer(row, row)


def _marginalise(square: Array, nuisance: slice, sigmas: tuple[float, ...]) -> Array:
    """Square of a table with the columns `nuisance` marginalised; `sigmas`: their prior."""
    block = square[nuisance, nuisance] + np.diag(np.array(sigmas) ** -2.0)
    kept_columns = np.delete(np.arange(len(square)), nuisance)
    cross = square[nuisance][:, kept_columns]
    return square[np.ix_(kept_columns, kept_columns)] - cross.T @ np.linalg.solve(block, cross)


def visible_height(
    kind: ObstacleTemplate,
    rows: HeightRows,
    start_m: float,
    length_m: float,
    height_m: float,
    ramp: float | None = None,
) -> Array:
    """Height (n,) at which each line of sight first meets the shape, averaged over the smear; 0 beside it."""
    share = float(ramp_share(kind, length_m)) if ramp is None else ramp
    return _smeared_heights(kind, rows, np.array([[start_m, length_m, height_m, share]]))[0].mean(axis=1)


def _smeared_heights(kind: ObstacleTemplate, rows: HeightRows, shapes: Array) -> Array:
    """Heights (shapes, n, 3) near, amid and far in the smear that `visible_height` averages.

    shapes: (shapes, 4) near edge, length, height, and the share of a ramp.
    """
    start, length, height, ramp = shapes.T[:, :, None]
    stations = start + _PROFILE_POINTS * length
    rises = height * unit_profile(kind, _PROFILE_POINTS, length, ramp)
    # Intersection with the plane of the line of sight through each point; hidden points do not advance it.
    plane_crossings = np.maximum.accumulate(
        stations[:, None, :] + rises[:, None, :] * rows.slant[:, None], axis=2
    )
    positions = rows.x_m[:, None] + rows.smear_m[:, None] * _SMEAR_POINTS
    points_before = (plane_crossings[:, :, None, :] < positions[:, :, None]).sum(axis=3)
    before_end = points_before < len(_PROFILE_POINTS)  # and before the near edge the height is the edge's, 0
    k = np.clip(points_before, 1, len(_PROFILE_POINTS) - 1)
    low, high = (
        np.take_along_axis(plane_crossings, k - 1, axis=2),
        np.take_along_axis(plane_crossings, k, axis=2),
    )
    # Over a hidden stretch the height jumps: the far end of the stretch counts.
    fraction = np.clip((positions - low) / np.maximum(high - low, 1e-9), 0.0, 1.0)
    shape_index = np.arange(len(shapes))[:, None, None]
    near_height = rises[shape_index, k - 1]
    return np.where(before_end, near_height + fraction * (rises[shape_index, k] - near_height), 0.0)
