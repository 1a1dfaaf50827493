"""`oracle`: the true road ahead, or one that is wrong in ways that can be set one by one."""

from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from files.errors import InputError
from preview.horizon import RoadPreview, oracle_preview
from road.envelope import WheelProfile, wheel_profile
from road.enveloping import Enveloping
from road.features import Feature, HalfSineBump, Pothole
from road.profile import Road
from scenarios.perception import Blind
from vehicle.parameters import Car
from vehicle.sensors import Measurement
from vehicle.state import VehicleState


@dataclass(frozen=True)
class OracleErrors:
    """How what the oracle says differs from the truth, and what it admits of it.

    bias_m: features are believed this much farther ahead than they are; negative: nearer.
    height_gain: believed over true height.
    latency_s: age of the view, carried forward by the measured speed.
    miss_probability: of each feature, for the whole drive. false_per_100m: mean number of bumps and potholes
    that are not there.
    position_sigma_m, height_sigma (relative), existence: what it says of its own quality.
    """

    bias_m: float = 0.0
    height_gain: float = 1.0
    latency_s: float = 0.0
    miss_probability: float = 0.0
    false_per_100m: float = 0.0
    position_sigma_m: float = 0.0
    height_sigma: float = 0.0
    existence: float = 1.0

    def __post_init__(self) -> None:
        allowed = {
            "bias_m": (-5.0, 5.0), "height_gain": (0.0, 5.0), "latency_s": (0.0, 1.0),
            "miss_probability": (0.0, 1.0), "false_per_100m": (0.0, 50.0), "position_sigma_m": (0.0, 5.0),
            "height_sigma": (0.0, 5.0), "existence": (0.0, 1.0),
        }  # fmt: skip
        for name, (low, high) in allowed.items():
            if not low <= getattr(self, name) <= high:
                raise InputError(f"{name} must lie in {low:g} ... {high:g}, got {getattr(self, name):g}")


class Oracle(Blind):
    """The believed profile ahead of each wheel, seen from where the car was `latency_s` ago."""

    def __init__(self, believed: Sequence[WheelProfile], car: Car, errors: OracleErrors):
        super().__init__()
        self._believed, self._errors = believed, errors
        self._exact = errors == OracleErrors()
        self._axles = np.asarray(car.axle_x_m)
        self._speed_m_s = 0.0
        self._travelled_m = 0.0
        self._views: deque[tuple[float, float, float]] = deque()

    def sense(self, measurement: Measurement) -> None:
        """Note the speed, which carries old views forward."""
        self._speed_m_s = measurement.speed_m_s

    def preview(self, time_s: float, state: Callable[[], VehicleState]) -> RoadPreview:
        """The believed profile ahead now."""
        x_m = float(state().x_m)
        errors = self._errors
        if errors.latency_s > 0.0:
            x_m = self._carried_forward(time_s, x_m)
        seen = oracle_preview(self._believed, x_m - errors.bias_m + self._axles, time_s)
        if self._exact:
            return seen
        height = errors.height_gain * seen.height_m
        return replace(
            seen,
            height_m=height,
            position_sigma_m=np.full_like(height, errors.position_sigma_m),
            height_sigma_m=errors.height_sigma * np.abs(height),
            existence=np.full_like(height, errors.existence),
            age_s=errors.latency_s,
        )

    def _carried_forward(self, time_s: float, x_m: float) -> float:
        """Where the car believes to be: where it was at the view's time, and what it has measured since."""
        if self._views:
            self._travelled_m += self._speed_m_s * (time_s - self._views[-1][0])
        self._views.append((time_s, x_m, self._travelled_m))
        while len(self._views) > 1 and self._views[1][0] <= time_s - self._errors.latency_s:
            self._views.popleft()
        _, then_m, travelled_m = self._views[0]
        return then_m + self._travelled_m - travelled_m


def build_oracle(
    road: Road,
    true: Sequence[WheelProfile],
    car: Car,
    errors: OracleErrors,
    rng: np.random.Generator,
    enveloping: Enveloping | None = None,
) -> Oracle:
    """The oracle of a drive; what it misses and imagines is drawn once."""
    if errors.miss_probability == errors.false_per_100m == 0.0:
        return Oracle(true, car, errors)
    believed = believed_road(road, car.track_m, errors, rng)
    tracks = {y: wheel_profile(believed, y, car.wheel_radius_m, enveloping) for y in car.wheel_y_m}
    return Oracle([tracks[y] for y in car.wheel_y_m], car, errors)


def believed_road(road: Road, track_m: float, errors: OracleErrors, rng: np.random.Generator) -> Road:
    """The road without the features that are missed, with those that are imagined."""
    found = rng.random(len(road.features)) >= errors.miss_probability
    kept = [feature for feature, seen in zip(road.features, found, strict=True) if seen]
    count = rng.poisson(errors.false_per_100m * road.length_m / 100.0)
    imagined = [_imagined(start, track_m, rng) for start in rng.uniform(0.0, road.length_m - 1.0, count)]
    return replace(road, features=(*kept, *imagined))


def _imagined(start_m: float, track_m: float, rng: np.random.Generator) -> Feature:
    """A bump across the lane or a pothole on the right track, of common size."""
    size, length = float(rng.uniform(0.04, 0.08)), float(rng.uniform(0.35, 0.8))
    if rng.random() < 0.5:
        return HalfSineBump(float(start_m), size, length)
    return Pothole(float(start_m), size, length, 0.6, -track_m / 2, seed=int(rng.integers(1000)))
