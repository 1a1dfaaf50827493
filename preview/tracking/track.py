"""Track of one object: boxes, fits, lateral extent, class and existence."""

import math
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from foreride.detector.calibration import ClassCalibration
from foreride.preview.ego_motion.heave_pitch_filter import PlaneUpdate
from foreride.preview.obstacle_classes import ObstacleTemplate, templates_of
from foreride.preview.settings import Settings
from foreride.preview.tracking.gauss_newton import (
    SHARED,
    DirectMeasurement,
    EdgeBearings,
    Fit,
    fits,
    start_state,
    table,
)
from foreride.preview.tracking.height_likelihood import HeightSamples
from foreride.preview.tracking.mounting_filter import Gaussian
from foreride.preview.tracking.object_state import HEIGHT, LENGTH, X
from foreride.preview.tracking.obstacle_templates import chord
from foreride.preview.tracking.plane_residual import residual_variance_ratio
from foreride.preview.tracking.realness import mean_surplus, probability, surplus

Array = np.ndarray
_MIN_SHARE = 0.03  # least probability of a kind that the preview takes into account
_DROP_EVIDENCE = 10.0  # log evidence against a kind at which it is dropped
_MIN_BEARINGS = 8  # before a kind may be dropped
_MAX_VARIANCE_RATIO = 2.5  # variance ratio above which the boxes contradict a plane road
_PLANE_UNCHANGED_RAD = 0.002  # threshold below which the plane counts as unchanged
_SIGMA_INFLATION = 2.0  # sigma inflation per unit above; calibrated for grade changes of 2 %
LOG_ODDS_LIMIT = 7.0  # so that a vanished object is deleted after half a second


@dataclass
class Edge:
    """Lateral position of one side of the object, left-positive (m): a scalar Kalman filter."""

    y_m: float
    variance: float

    def update(self, y_m: float, variance: float) -> None:
        """Update with one measurement."""
        gain = self.variance / (self.variance + variance)
        self.y_m += gain * (y_m - self.y_m)
        self.variance *= 1.0 - gain


class Section(NamedTuple):
    """Section of an object on a wheel's path: near edge, length and height (or depth), m."""

    start_m: float
    length_m: float
    height_m: float


@dataclass
class Track:
    """Track of an object detected at least once. Positions are on the odometer's axis.

    right, left: lateral edges (y_min, y_max). log_odds: against a chance detection; class_log_odds: of `cls`
    against the other class. score_surplus: see `preview.tracking.realness`. real_probability: probability
    that a repeatedly detected object with such scores is real; 1 after a wheel strike. fits: by kind.
    variance_ratio: of the residuals, see `preview.tracking.plane_residual`. turned_rad: total rotation of the
    road plane since the first detection. wheel_compared: whether the wheel's profile was compared with it.
    mark_position: near edge and sigma by `preview.geometry.cross_ratio`, which then replace those of the fit.
    shapes: cache of `preview.wheel_shapes`.
    """

    identity: int
    cls: int
    born_s: float
    log_odds: float
    right: Edge
    left: Edge
    fits: tuple[Fit, ...]
    bearings: list[EdgeBearings] = field(default_factory=list)
    direct_measurements: list[DirectMeasurement] = field(default_factory=list)
    elevation: HeightSamples | None = None
    last_seen_s: float = 0.0
    last_seen_x_m: float = 0.0
    hits: int = 1
    confirmed: bool = False
    wheel_compared: bool = False
    variance_ratio: float = 0.0
    score_surplus: float = 0.0
    real_probability: float = 1.0
    class_log_odds: float = 0.0
    mark_position: tuple[float, float] | None = None
    turned_rad: float = 0.0
    shapes: Any = field(default=None, repr=False, compare=False)
    _best: tuple[tuple[Fit, ...], Fit] | None = field(default=None, init=False, repr=False, compare=False)

    @property
    def best(self) -> Fit:
        """Fit of the kind with the highest evidence."""
        if self._best is None or self._best[0] is not self.fits:
            self._best = self.fits, min(self.fits, key=lambda candidate: candidate.cost)
        return self._best[1]

    @property
    def existence(self) -> float:
        """Probability that the object is real.

        Repeated boxes separate it from chance detections; only scores separate it from a look-alike such as a
        stain.
        """
        return float(self.real_probability / (1.0 + np.exp(-self.log_odds)))

    @property
    def contradicts_plane(self) -> bool:
        """True if the boxes contradict a plane road: its grade has changed on the way."""
        return self.variance_ratio > _MAX_VARIANCE_RATIO

    @property
    def is_of_one_plane(self) -> bool:
        """True if all boxes belong to one road plane, according to boxes and wheels."""
        return not self.contradicts_plane and self.turned_rad < _PLANE_UNCHANGED_RAD

    @property
    def sigma_m(self) -> float:
        """Standard deviation of the near edge, inflated where the boxes contradict a plane road.

        A stereo pair does not assume a plane road.
        """
        if self.elevation is not None and self.elevation.absolute:
            return self.best.sigma_m
        return self.best.sigma_m * (
            1.0 + _SIGMA_INFLATION * max(0.0, self.variance_ratio - _MAX_VARIANCE_RATIO)
        )

    @property
    def start_m(self) -> float:
        """Position of the near edge."""
        return float(self.best.state[X])

    @property
    def end_m(self) -> float:
        """Position of the far edge."""
        state = self.best.state
        return float(state[X] + state[LENGTH])

    @property
    def centre_y_m(self) -> float:
        """Lateral position of the middle."""
        return 0.5 * (self.left.y_m + self.right.y_m)

    @property
    def depth_is_measured(self) -> bool:
        """True if a pothole's depth is known beyond its prior: from images or an earlier drive."""
        return self.elevation is not None or any(
            measurement.entry == HEIGHT for measurement in self.direct_measurements
        )

    @property
    def height_sigma(self) -> float:
        """Relative standard deviation of height or depth."""
        return relative_height_sigma(self.best)

    def is_certain(self, x_m: float, settings: Settings) -> bool:
        """True if the existence suffices to confirm the track, seen from a camera at `x_m`."""
        near = self.start_m - x_m < settings.near_confirm_m
        least = settings.near_confirm_existence if near else settings.confirm_existence
        return self.existence > least[self.cls]

    def update_existence(self, detected: bool, settings: Settings) -> None:
        """Bayesian update of existence after a frame in which the object should have been visible."""
        p_detection, p_false = settings.detection_probability, settings.false_repeat_probability
        ratio = p_detection / p_false if detected else (1.0 - p_detection) / (1.0 - p_false)
        self.log_odds = float(np.clip(self.log_odds + np.log(ratio), -LOG_ODDS_LIMIT, LOG_ODDS_LIMIT))

    def update_score(
        self, score: float, height_px: float, settings: Settings, calibration: ClassCalibration
    ) -> None:
        """Update of the score evidence.

        It is skipped for an object proved real by a wheel strike, in this drive or an earlier one.
        """
        if self.real_probability < 1.0:
            self.score_surplus = mean_surplus(self.score_surplus, surplus(score, height_px, calibration))
            prior = settings.real_probability[self.cls]
            self.real_probability = min(prior, probability(self.score_surplus, calibration))

    def classify(self, detected_class: int, shared: Gaussian, settings: Settings) -> None:
        """Bayesian update of the class; a change of class restarts the fits."""
        confusion = settings.confusion_probability
        evidence = math.log((1.0 - confusion) / confusion) * (1.0 if detected_class == self.cls else -1.0)
        self.class_log_odds = min(self.class_log_odds + evidence, LOG_ODDS_LIMIT)
        if self.class_log_odds < 0:
            self.cls, self.class_log_odds = detected_class, -self.class_log_odds
            self.score_surplus, self.real_probability = 0.0, settings.real_probability[detected_class]
            self.fits = first_fits(detected_class, self.start_m, self.best.sigma_m, shared)
            # The position remains valid; remembered sizes belong to the other class.
            self.direct_measurements = [
                measurement for measurement in self.direct_measurements if measurement.entry == X
            ]

    def refit(self, shared: Gaussian, settings: Settings) -> None:
        """Fit every remaining kind to all bearings, starting from its last fit."""
        del self.bearings[: -settings.max_boxes]
        bearings = table(self.bearings)
        starts = {previous.kind: previous.state for previous in self.fits}
        measured = self.direct_measurements
        found = fits(starts, bearings, shared, measured, settings, 2, self.elevation)
        best_cost = min(candidate.cost for candidate in found)
        enough_bearings = len(self.bearings) >= _MIN_BEARINGS
        self.fits = tuple(
            candidate
            for candidate in found
            if not enough_bearings or candidate.cost < best_cost + _DROP_EVIDENCE
        )
        self.variance_ratio = residual_variance_ratio(bearings, self.best.state)

    def turn(self, x_m: float, turn: PlaneUpdate) -> None:
        """Transform all bearings to a road plane that was updated at odometer reading `x_m`."""
        self.turned_rad += abs(turn.pitch_rad)
        for index, bearings in enumerate(self.bearings):
            camera_z = bearings.camera_z + turn.heave_m + (x_m - bearings.camera_x) * turn.pitch_rad
            bottom, top = bearings.bottom + turn.pitch_rad, bearings.top + turn.pitch_rad
            self.bearings[index] = bearings._replace(camera_z=camera_z, bottom=bottom, top=top)

    def place(self, x_m: float, sigma_m: float) -> None:
        """Set the near edge to a position from another source than the fit, with its standard deviation."""
        self.fits = tuple(candidate.placed(x_m, sigma_m) for candidate in self.fits)

    def position_sigma_m(self, x_m: float, settings: Settings) -> float:
        """Standard deviation of the near edge relative to the car, whose odometer reads `x_m`."""
        drift = settings.odometry_sigma * (x_m - self.last_seen_x_m)
        return float(np.hypot(self.sigma_m, drift))

    def overlap(self, y_m: float) -> float:
        """Probability that the line y = `y_m` runs over the object."""
        inside_right = _normal_cdf((y_m - self.right.y_m) / np.sqrt(self.right.variance))
        inside_left = _normal_cdf((self.left.y_m - y_m) / np.sqrt(self.left.variance))
        return inside_right * inside_left

    def section(self, y_m: float, candidate: Fit | None = None) -> Section:
        """Section on the line y = `y_m`, by the best fit or another one; a hole is an ellipse."""
        shape = self.best if candidate is None else candidate
        start, length, height = shape.state[[X, LENGTH, HEIGHT]].tolist()
        if shape.kind.sign > 0:
            return Section(start, length, height)
        beside = y_m - self.centre_y_m
        cut = max(chord(length, self.left.y_m - self.right.y_m, beside), 0.5 * length)
        return Section(start + 0.5 * (length - cut), cut, height)

    @property
    def probable(self) -> list[tuple[float, Fit]]:
        """Fits with their posterior probabilities, those below a few per cent left out."""
        odds = np.exp([self.best.cost - candidate.cost for candidate in self.fits])
        shares = odds / odds.sum()
        kept = [
            (float(share), one) for share, one in zip(shares, self.fits, strict=True) if share > _MIN_SHARE
        ]
        total = sum(share for share, _ in kept)
        return [(share / total, candidate) for share, candidate in kept]


def relative_height_sigma(candidate: Fit) -> float:
    """Relative standard deviation of a fit's height."""
    return float(np.sqrt(candidate.covariance[HEIGHT, HEIGHT]) / candidate.state[HEIGHT])


def first_fits(cls: int, x_m: float, x_sigma_m: float, shared: Gaussian) -> tuple[Fit, ...]:
    """Initial fits of a new object from the ground position of its first box."""
    return tuple(_first_fit(kind, x_m, x_sigma_m, shared) for kind in templates_of(cls))


def _normal_cdf(value: float) -> float:
    return 0.5 * (1.0 + math.erf(value / math.sqrt(2.0)))


def _first_fit(kind: ObstacleTemplate, x_m: float, x_sigma_m: float, shared: Gaussian) -> Fit:
    state = start_state(x_m, shared, kind.length_m, kind.height_m)
    covariance = np.zeros((len(state), len(state)))
    covariance[np.ix_(SHARED, SHARED)] = shared.covariance
    own = [X, LENGTH, HEIGHT]
    covariance[own, own] = np.square([x_sigma_m, kind.length_sigma_m, kind.height_sigma_m])
    return Fit(kind, state, covariance, -float(np.log(kind.share)))
