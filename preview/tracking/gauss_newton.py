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

from typing import NamedTuple

import numpy as np

from foreride.preview.obstacle_classes import ObstacleTemplate
from foreride.preview.settings import Settings
from foreride.preview.tracking.height_likelihood import HeightSamples, equations
from foreride.preview.tracking.mounting_filter import Gaussian
from foreride.preview.tracking.object_state import EDGE_BIAS, GROUND, HEIGHT, LENGTH, OFFSET, X
from foreride.preview.tracking.obstacle_templates import unit_profile

Array = np.ndarray
SHARED = np.array([OFFSET, GROUND, EDGE_BIAS])  # states with a component common to all objects
_SHARED_BLOCK = np.ix_(SHARED, SHARED)
_PROFILE_POINTS = np.linspace(0.0, 1.0, 21)
_MIN_STATE = np.array([-np.inf, -0.1, -0.2, 0.1, 0.01, -0.03])
_MAX_STATE = np.array([np.inf, 0.1, 0.2, 9.0, 0.3, 0.03])
_X_MARGIN_BEHIND_M, _X_MARGIN_AHEAD_M = (
    10.0,
    100.0,
)  # limits of X relative to the cameras, for lines of sight near the horizon
_CAUCHY = 2.5  # residual in standard deviations with half weight


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
    """Maximum a posteriori state for all `bearings` (or their `table`), from `start`.

    kind and shared hold the priors; directs are direct measurements of single states, such as the position of
    a wheel strike; elevation holds height samples measured in images.
    """
    priors = [
        DirectMeasurement(LENGTH, kind.length_m, kind.length_sigma_m),
        DirectMeasurement(HEIGHT, kind.height_m, kind.height_sigma_m),
        *direct_measurements,
    ]
    entries, values, sigmas = np.array(priors).T
    index = entries.astype(int)
    shared_information = np.linalg.inv(shared.covariance)
    data = table(bearings)
    lower, upper = _MIN_STATE.copy(), _MAX_STATE.copy()
    if len(data):
        camera_x = data[:, _CAMERA_X]
        lower[X], upper[X] = camera_x.min() - _X_MARGIN_BEHIND_M, camera_x.max() + _X_MARGIN_AHEAD_M
    state = start.copy()
    for _ in range(iterations):
        information, gradient, cost = _normal_equations(kind, data, state, settings)
        if elevation is not None:
            elevation_terms = equations(kind, elevation, state)
            information, gradient, cost = (
                information + elevation_terms[0],
                gradient + elevation_terms[1],
                cost + elevation_terms[2],
            )
        deviation = shared.mean - state[SHARED]
        information[_SHARED_BLOCK] += shared_information
        gradient[SHARED] += shared_information @ deviation
        cost += 0.5 * float(deviation @ shared_information @ deviation)
        normalised = (values - state[index]) / sigmas
        np.add.at(information, (index, index), sigmas**-2)
        np.add.at(gradient, index, normalised / sigmas)
        cost += 0.5 * float((normalised**2).sum())
        state = np.clip(state + np.linalg.solve(information, gradient), lower, upper)
    # Laplace approximation of the evidence: prior normalisation and posterior volume.
    cost += float(np.log(sigmas).sum()) + 0.5 * float(np.linalg.slogdet(information)[1])
    return Fit(kind, state, np.linalg.inv(information), float(cost - np.log(kind.share)))


def silhouette(
    kind: ObstacleTemplate, state: Array, camera_x: Array, camera_z: Array
) -> tuple[Array, Array, Array]:
    """(ahead, below, share): the point of the profile on the silhouette, seen highest by each camera (n,).

    ahead, below: its distance and depth relative to the camera (m); share: position on the profile, 0..1.
    """
    ahead = state[X] + _PROFILE_POINTS * state[LENGTH] - camera_x[:, None]
    below = (
        camera_z[:, None] - state[GROUND] - state[HEIGHT] * unit_profile(kind, _PROFILE_POINTS, state[LENGTH])
    )
    # The slope below/ahead orders the angles for points in front; points behind the camera come last.
    slope = np.where(ahead > 0.05, below / np.maximum(ahead, 0.05), np.inf)
    best = np.argmin(slope, axis=1)
    rows = np.arange(len(best))
    return ahead[rows, best], below[rows, best], _PROFILE_POINTS[best]


def _normal_equations(
    kind: ObstacleTemplate, data: Array, state: Array, settings: Settings
) -> tuple[Array, Array, float]:
    """Information (6, 6), gradient (6,) and half the robust squared error of the boxes."""
    _, camera_x, camera_z, bottom_angle, top_angle, bottom_sigma, top_sigma = data.T
    ahead, below, share = silhouette(kind, state, camera_x, camera_z)
    ahead = np.concatenate([state[X] - camera_x, ahead])
    below = np.concatenate([camera_z - state[GROUND], below])
    share = np.concatenate([np.zeros(len(data)), share])
    rise = np.concatenate([np.zeros(len(data)), unit_profile(kind, share[len(data) :], state[LENGTH])])
    measured = np.concatenate([bottom_angle, top_angle])
    sigma = np.concatenate([bottom_sigma, top_sigma])

    bottom = np.concatenate([np.ones(len(data)), np.zeros(len(data))])
    residual = measured + state[OFFSET] - bottom * state[EDGE_BIAS] - np.arctan2(below, ahead)
    observed = np.isfinite(residual)
    square = ahead**2 + below**2
    by_ahead, by_below = -below / square, ahead / square  # derivatives of the modelled angle
    # Jacobian of (model - measured); at the silhouette the derivative by the share vanishes.
    jacobian = np.stack(
        [by_ahead, -np.ones_like(ahead), -by_below, by_ahead * share, -by_below * rise, bottom], axis=1
    )
    normalised = np.where(observed, residual / sigma, 0.0)
    robust = 1.0 + (normalised / _CAUCHY) ** 2
    weight = np.where(observed, 1.0 / (robust * sigma**2 * settings.correlation), 0.0)
    weighted = jacobian * weight[:, None]
    cost = 0.5 * _CAUCHY**2 * float(np.log(robust).sum()) / settings.correlation
    return weighted.T @ jacobian, weighted.T @ np.where(observed, residual, 0.0), cost
