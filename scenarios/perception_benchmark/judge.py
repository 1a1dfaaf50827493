"""Matching of the estimator's tracks to the true obstacles of a drive."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from foreride.preview.obstacle_classes import TEMPLATE_OF_FEATURE
from foreride.road.features.feature import Feature
from foreride.road.obstacle_classes import CLASS_NAMES
from foreride.scenarios.definition.clock import TICKS_PER_SECOND
from foreride.scenarios.perceptions.interface import Event
from foreride.scenarios.simulation.simulate import Run

EVALUATION_DISTANCE_M = 2.5
"""Distance of the front wheel from the near edge at which an estimate is evaluated, m."""

_MAX_AGE_S = 0.2  # an estimate dropped earlier than this is not used
_GATE_M, _GATE_SHARE = 1.2, 0.12


@dataclass(frozen=True)
class TrackEstimate:
    """Track estimate at one arrival of boxes, matched to an obstacle.

    distance_m: true distance from the front wheel to the near edge; error_m: estimated minus true (positive:
    too far); sigma_m: standard deviation stated by the estimator; height_m: estimated, negative for potholes.
    """

    time_s: float
    distance_m: float
    error_m: float
    sigma_m: float
    height_m: float
    kind: str
    track: int
    confirmed: bool


@dataclass(frozen=True)
class Encounter:
    """Encounter with one obstacle: all estimates of it, oldest first, and the speed at contact."""

    feature: Feature
    speed_m_s: float
    track_estimates: tuple[TrackEstimate, ...]

    @property
    def used(self) -> TrackEstimate | None:
        """Last confirmed estimate `EVALUATION_DISTANCE_M` or farther away; None if it was missed."""
        ahead = [
            track_estimate
            for track_estimate in self.track_estimates
            if track_estimate.confirmed and track_estimate.distance_m >= EVALUATION_DISTANCE_M
        ]
        recent = bool(ahead) and ahead[-1].distance_m < EVALUATION_DISTANCE_M + _MAX_AGE_S * self.speed_m_s
        return ahead[-1] if recent else None

    @property
    def first_confirmed_m(self) -> float | None:
        """Distance of the front wheel when a track of this obstacle was first confirmed."""
        return next(
            (
                track_estimate.distance_m
                for track_estimate in self.track_estimates
                if track_estimate.confirmed
            ),
            None,
        )

    @property
    def true_height_m(self) -> float:
        """Height of the crest, or depth of a pothole as a negative number."""
        return self.feature.crest_m

    @property
    def true_kind(self) -> str:
        """Name of the kind as in the estimator."""
        template = TEMPLATE_OF_FEATURE.get(self.feature.kind)
        return self.feature.kind if template is None else template.name


def encounters(run: Run) -> list[Encounter]:
    """Every obstacle of the drive with its estimates."""
    axle = max(run.case.scenario.vehicle.parameters.axle_x_m)
    speed = run.signals["speed_m_s"]
    results = []
    for feature in _obstacles(run):
        contact_tick = int(np.searchsorted(run.signals["x_m"] + axle, feature.start_m))
        track_estimates = tuple(_best_estimates(run, feature, axle))
        results.append(Encounter(feature, float(speed[min(contact_tick, len(speed) - 1)]), track_estimates))
    return results


def false_tracks(run: Run) -> int:
    """Number of confirmed tracks that never came near any obstacle of their class."""
    axle = max(run.case.scenario.vehicle.parameters.axle_x_m)
    matched: set[int] = set()
    for feature in _obstacles(run):
        matched |= {track_estimate.track for track_estimate in _all_estimates(run, feature, axle)}
    confirmed = {row["track"] for event in _arrivals(run) for row in event["tracks"] if row["confirmed"]}
    return len(confirmed - matched)


def _obstacles(run: Run) -> Iterator[Feature]:
    """Features that the detector is trained for; not joints, covers and steps."""
    return (feature for feature in run.case.scenario.road.features if feature.cls is not None)


def _arrivals(run: Run) -> Iterator[Event]:
    return (event for event in run.events if event["event"] == "boxes")


def _best_estimates(run: Run, feature: Feature, axle: float) -> Iterator[TrackEstimate]:
    """Best estimate of the obstacle at each arrival, until the front wheel reaches it."""
    by_time: dict[float, TrackEstimate] = {}
    for track_estimate in _all_estimates(run, feature, axle):
        previous = by_time.get(track_estimate.time_s)
        if previous is None or (track_estimate.confirmed, -abs(track_estimate.error_m)) > (
            previous.confirmed,
            -abs(previous.error_m),
        ):
            by_time[track_estimate.time_s] = track_estimate
    return iter(by_time.values())


def _all_estimates(run: Run, feature: Feature, axle: float) -> Iterator[TrackEstimate]:
    x = run.signals["x_m"]
    for event in _arrivals(run):
        wheel = float(x[min(round(event["time_s"] * TICKS_PER_SECOND), len(x) - 1)]) + axle
        distance = feature.start_m - wheel
        if distance < 0:
            break
        for row in event["tracks"]:
            error = (row["x_m"] - event["odometer_m"] - axle) - distance
            gate_m = _GATE_M + _GATE_SHARE * distance
            if feature.cls is not None and row["class"] == CLASS_NAMES[feature.cls] and abs(error) < gate_m:
                yield TrackEstimate(
                    event["time_s"], distance, error, row["sigma_m"], row["height_m"], row["kind"],
                    row["track"], row["confirmed"],
                )  # fmt: skip
