"""Perception `oracle`: the true road ahead, optionally with prescribed errors."""

from collections import deque
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from foreride.preview.road_preview import PREVIEW_M, RoadPreview, distance_grid
from foreride.road.features.feature import Feature, HalfSineBump, Pothole
from foreride.road.road import Road
from foreride.road.tyre.wheel_profile import WheelProfile, wheel_profile
from foreride.scenarios.definition.oracle_errors import OracleErrors
from foreride.scenarios.perceptions.interface import Drive, Perception
from foreride.scenarios.perceptions.plane_frame import PlaneFrame
from foreride.vehicle.load import Car
from foreride.vehicle.plant.sensors import Measurement
from foreride.vehicle.state import VehicleState

_NO_ROUGHNESS = dict.fromkeys(("roughness", "file", "file_sha256", "reading"))
"""Fields of a road without roughness and measured heights."""


class OraclePerception(Perception):
    """Perception from the believed profile of each wheel, seen from the car's position `latency_s` ago.

    unseen_sigma_m: standard deviation of the road that the believed profiles do not contain.
    """

    def __init__(
        self,
        believed: Sequence[WheelProfile],
        car: Car,
        errors: OracleErrors,
        ahead_m: float = PREVIEW_M,
        unseen_sigma_m: float = 0.0,
    ):
        super().__init__()
        self._errors = errors
        self._unseen_sigma_m = unseen_sigma_m
        self._exact = errors == OracleErrors()
        self._tracks = list(zip(believed, car.axle_x_m, strict=True))
        self._frame = PlaneFrame(car)
        self._grid = distance_grid(ahead_m=ahead_m)
        self._ahead_m, self._here = self._grid.copy(), int(np.searchsorted(self._grid, 0.0))
        self._speed_m_s = 0.0
        self._travelled_m = 0.0
        self._views: deque[tuple[float, float, float]] = deque()

    def sense(self, measurement: Measurement) -> None:
        """Record the measured speed, used to extrapolate old views."""
        self._speed_m_s = measurement.speed_m_s

    def preview(self, time_s: float, state: VehicleState) -> RoadPreview:
        """Return the believed profile ahead of the wheels."""
        x_m = float(state.x_m)
        errors = self._errors
        if errors.latency_s > 0.0:
            x_m = self._carried_forward(time_s, x_m)
        height = self._relative_heights(time_s, x_m - errors.bias_m, state)
        if self._exact:
            return RoadPreview.exact(time_s, self._grid, height, height[:, self._here].copy())
        height *= errors.height_gain
        return RoadPreview(
            time_s,
            self._grid,
            height,
            position_sigma_m=np.full_like(height, errors.position_sigma_m),
            height_sigma_m=np.hypot(errors.height_sigma * height, self._unseen_sigma_m),
            existence=np.full_like(height, errors.existence),
            age_s=errors.latency_s,
        )

    def _relative_heights(self, time_s: float, x_m: float, state: VehicleState) -> np.ndarray:
        """Believed heights (wheels, n) ahead of the wheels of a car at x_m, over the plane of its road."""
        height = np.empty((len(self._tracks), len(self._grid)))
        for (profile, axle_m), row in zip(self._tracks, height, strict=True):
            profile.heights_ahead(x_m + axle_m, self._ahead_m, row)
        frame, here_m = self._frame, height[:, self._here].copy()
        frame.lower(time_s, height, self._grid, here_m, float(state.speed_m_s), frame.body_velocity(state))
        return height

    def _carried_forward(self, time_s: float, x_m: float) -> float:
        """Position extrapolated from the view's time by the measured speed."""
        if self._views:
            self._travelled_m += self._speed_m_s * (time_s - self._views[-1][0])
        self._views.append((time_s, x_m, self._travelled_m))
        while len(self._views) > 1 and self._views[1][0] <= time_s - self._errors.latency_s:
            self._views.popleft()
        _, then_m, travelled_m = self._views[0]
        return then_m + self._travelled_m - travelled_m


def build_oracle(drive: Drive) -> OraclePerception:
    """Build the oracle of a drive; missed and false features are drawn once."""
    return _oracle(drive, drive.scenario.oracle)


def build_obstacles(drive: Drive) -> OraclePerception:
    """Build the oracle of a drive that sees the features of the road alone."""
    return _oracle(drive, replace(drive.scenario.oracle, roughness=False))


def _oracle(drive: Drive, errors: OracleErrors) -> OraclePerception:
    scenario, car = drive.scenario, drive.scenario.vehicle.parameters
    if errors.roughness and errors.miss_probability == errors.false_per_100m == 0.0:
        return OraclePerception(drive.profiles, car, errors, scenario.preview_m)
    believed = believed_road(scenario.road, car.track_m, errors, drive.random_stream("oracle"))
    tracks = {y: wheel_profile(believed, y, car.wheel_radius_m, scenario.enveloping) for y in car.wheel_y_m}
    unseen_m = 0.0 if errors.roughness else scenario.estimator.background_sigma_m
    return OraclePerception([tracks[y] for y in car.wheel_y_m], car, errors, scenario.preview_m, unseen_m)


def believed_road(road: Road, track_m: float, errors: OracleErrors, rng: np.random.Generator) -> Road:
    """Road without the missed features and with the false ones, without roughness if that is not seen."""
    found = rng.random(len(road.features)) >= errors.miss_probability
    kept = [feature for feature, seen in zip(road.features, found, strict=True) if seen]
    count = rng.poisson(errors.false_per_100m * road.length_m / 100.0)
    imagined = [_false_feature(start, track_m, rng) for start in rng.uniform(0.0, road.length_m - 1.0, count)]
    hidden: dict[str, Any] = {} if errors.roughness else _NO_ROUGHNESS
    return replace(road, features=(*kept, *imagined), **hidden)


def _false_feature(start_m: float, track_m: float, rng: np.random.Generator) -> Feature:
    """False feature of common size: a bump across the lane or a pothole on the right track."""
    size, length = float(rng.uniform(0.04, 0.08)), float(rng.uniform(0.35, 0.8))
    if rng.random() < 0.5:
        return HalfSineBump(float(start_m), size, length)
    return Pothole(float(start_m), size, length, 0.6, -track_m / 2, seed=int(rng.integers(1000)))
