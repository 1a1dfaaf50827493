"""Gauss-Newton fit of one object to all its boxes: position, size and camera pitch offset.

State s = [X, b, z, L, H, d]: near edge X (m), pitch offset b (rad), ground height z at the object over the
local road plane (m), length L and height or depth H (m), bottom-edge bias d (rad), positive for detected
bottom edges that are too low. A box seen from a camera at (x_c, h) gives
    bottom row:  depression + pitch + b - d = atan2(h - z, X - x_c)
    top row:     depression + pitch + b = the smallest atan2(h - z - H p(t), X + t L - x_c) over t in 0..1
with p the unit profile of the kind: the top of the box is the silhouette of crest or far edge. Gaussian
priors regularise the problem; a Cauchy loss bounds the influence of a wrong box (Triggs et al., Bundle
adjustment, 2000).
"""

from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple

import numpy as np

from foreride.files.jit import njit
from foreride.preview.obstacle_classes import ObstacleTemplate
from foreride.preview.settings import Settings
from foreride.preview.tracking.box_equations import box_equations, profile_points
from foreride.preview.tracking.height_likelihood import HeightSamples, equations
from foreride.preview.tracking.mounting_filter import Gaussian
from foreride.preview.tracking.object_state import EDGE_BIAS, GROUND, HEIGHT, LENGTH, OFFSET, X

Array = np.ndarray
SHARED = np.array([OFFSET, GROUND, EDGE_BIAS])  # states with a component common to all objects
_SHARED_BLOCK = np.ix_(SHARED, SHARED)
_MIN_STATE = np.array([-np.inf, -0.1, -0.2, 0.1, 0.01, -0.03])
_MAX_STATE = np.array([np.inf, 0.1, 0.2, 9.0, 0.3, 0.03])
_X_MARGIN_BEHIND_M, _X_MARGIN_AHEAD_M = (
    10.0,
    100.0,
)  # limits of X relative to the cameras, for lines of sight near the horizon


class EdgeBearings(NamedTuple):
    """Edge bearings of one box; nan for an edge cut off by the image border or the bonnet.

    time_s: exposure. camera_x, camera_z: m; bottom, top: depression of the edges plus camera pitch (rad);
    then their sigmas.
    """

    time_s: float
    camera_x: float
    camera_z: float
    bottom: float
    top: float
    bottom_sigma: float
    top_sigma: float


_CAMERA_X = EdgeBearings._fields.index("camera_x")


class DirectMeasurement(NamedTuple):
    """Measurement of a single state entry by other means than boxes: index, value, standard deviation."""

    entry: int
    value: float
    sigma: float


class Fit(NamedTuple):
    """Result of a fit: state (6,) with covariance (6, 6).

    cost: negative log evidence, for the comparison of kinds.
    """

    kind: ObstacleTemplate
    state: Array
    covariance: Array
    cost: float

    @property
    def sigma_m(self) -> float:
        """Standard deviation of the near edge."""
        return float(np.sqrt(self.covariance[X, X]))

    def placed(self, x_m: float, sigma_m: float) -> "Fit":
        """The fit with its near edge at a position from another source, with its standard deviation."""
        state, covariance = self.state.copy(), self.covariance.copy()
        state[X], covariance[X], covariance[:, X] = x_m, 0.0, 0.0
        covariance[X, X] = sigma_m**2
        return self._replace(state=state, covariance=covariance)

    @property
    def shared(self) -> Gaussian:
        """Marginal of pitch offset, ground height and bottom-edge bias."""
        return Gaussian(self.state[SHARED], self.covariance[_SHARED_BLOCK])


def start_state(x_m: float, shared: Gaussian, length_m: float, height_m: float) -> Array:
    """Initial state (6,) of an object from position, size and shared states."""
    offset, ground, edge_bias = shared.mean
    return np.array([x_m, offset, ground, length_m, height_m, edge_bias])


def table(bearings: list[EdgeBearings] | Array) -> Array:
    """Edge bearings as rows (n, 7), columns as in `EdgeBearings`."""
    return np.asarray(bearings, dtype=float).reshape(-1, len(EdgeBearings._fields))


def fit(
    kind: ObstacleTemplate,
    bearings: list[EdgeBearings] | Array,
    start: Array,
    shared: Gaussian,
    direct_measurements: list[DirectMeasurement],
    settings: Settings,
    iterations: int = 3,
    elevation: HeightSamples | None = None,
) -> Fit:
    """Maximum a posteriori state for all `bearings` (or their `table`), from `start`; see `fits`."""
    starts = {kind: start}
    return fits(starts, bearings, shared, direct_measurements, settings, iterations, elevation)[0]


def fits(
    starts: Mapping[ObstacleTemplate, Array],
    bearings: list[EdgeBearings] | Array,
    shared: Gaussian,
    direct_measurements: list[DirectMeasurement],
    settings: Settings,
    iterations: int = 3,
    elevation: HeightSamples | None = None,
) -> tuple[Fit, ...]:
    """Maximum a posteriori state of each kind for all `bearings` (or their `table`), from that in `starts`.

    Kinds and shared hold the priors; directs are direct measurements of single states, such as the position
    of a wheel strike; elevation holds height samples measured in images.
    """
    kinds, data, priors = list(starts), table(bearings), _Priors.of(starts, shared, direct_measurements)
    lower, upper = _limits(data)
    states, n = np.array(list(starts.values())), len(kinds)
    information, gradient, cost = sums = np.empty((n, 6, 6)), np.empty((n, 6)), np.empty(n)
    for _ in range(iterations):
        profiles = np.array([profile_points(kind, states[k, LENGTH]) for k, kind in enumerate(kinds)])
        box_equations(data, profiles, states, settings.correlation, *sums)
        if elevation is not None:
            for k, kind in enumerate(kinds):
                for total, more in zip(sums, equations(kind, elevation, states[k]), strict=True):
                    total[k] += more
        _add_priors(states, *priors, *sums)
        steps = np.linalg.solve(information, gradient[:, :, None])[:, :, 0]
        states = np.clip(states + steps, lower, upper)
    # Laplace approximation of the evidence: prior normalisation and posterior volume.
    cost += np.log(priors.sigmas).sum(axis=1) + 0.5 * np.linalg.slogdet(information)[1]
    cost -= np.log([kind.share for kind in kinds])
    return tuple(map(Fit, kinds, states, np.linalg.inv(information), cost.tolist()))


def _limits(data: Array) -> tuple[Array, Array]:
    """Limits (6,) of a state seen from the cameras of these bearings."""
    lower, upper = _MIN_STATE.copy(), _MAX_STATE.copy()
    if len(data):
        camera_x = data[:, _CAMERA_X]
        lower[X], upper[X] = camera_x.min() - _X_MARGIN_BEHIND_M, camera_x.max() + _X_MARGIN_AHEAD_M
    return lower, upper


class _Priors(NamedTuple):
    """Priors of k hypotheses.

    mean (3,), information (3, 3): of the shared states; entries (m,), values and sigmas (k, m): of single
    states, by their kinds or measured.
    """

    mean: Array
    information: Array
    entries: Array
    values: Array
    sigmas: Array

    @classmethod
    def of(
        cls,
        kinds: Iterable[ObstacleTemplate],
        shared: Gaussian,
        measurements: list[DirectMeasurement],
    ) -> "_Priors":
        entries = np.array([LENGTH, HEIGHT, *(one.entry for one in measurements)])
        values = [[kind.length_m, kind.height_m, *(one.value for one in measurements)] for kind in kinds]
        sigmas = [
            [kind.length_sigma_m, kind.height_sigma_m, *(one.sigma for one in measurements)] for kind in kinds
        ]
        return cls(shared.mean, np.linalg.inv(shared.covariance), entries, np.array(values), np.array(sigmas))


@njit
def _add_priors(
    states: Any,
    mean: Any,
    shared_information: Any,
    entries: Any,
    values: Any,
    sigmas: Any,
    information: Any,
    gradient: Any,
    cost: Any,
) -> None:
    """Add the priors of each hypothesis to its information, gradient and cost."""
    for k in range(len(states)):
        for i in range(len(SHARED)):
            for j in range(len(SHARED)):
                pull = shared_information[i, j] * (mean[j] - states[k, SHARED[j]])
                information[k, SHARED[i], SHARED[j]] += shared_information[i, j]
                gradient[k, SHARED[i]] += pull
                cost[k] += 0.5 * (mean[i] - states[k, SHARED[i]]) * pull
        for m in range(len(entries)):
            entry, sigma = entries[m], sigmas[k, m]
            normalised = (values[k, m] - states[k, entry]) / sigma
            information[k, entry, entry] += sigma**-2
            gradient[k, entry] += normalised / sigma
            cost[k] += 0.5 * normalised**2
