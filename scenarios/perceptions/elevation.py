"""Elevation perceptions: a simulated LiDAR or stereo camera, and the elevation map that its points give."""

from collections import deque
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from time import perf_counter
from typing import Any

import numpy as np

from foreride.preview.elevation.estimator import ElevationEstimator
from foreride.preview.elevation.range_sensor import RangeSensor
from foreride.preview.road_preview import RoadPreview, distance_grid
from foreride.road.ranging.height_grid import HeightGrid
from foreride.road.ranging.ray_casting import cast
from foreride.road.road import Road
from foreride.scenarios.definition.clock import TICKS_PER_SECOND, due, next_due, ticks
from foreride.scenarios.perceptions.camera import pose, vehicle_facts
from foreride.scenarios.perceptions.interface import Drive, Event, Perception
from foreride.scenarios.perceptions.plane_frame import PlaneFrame
from foreride.vehicle.load import Car
from foreride.vehicle.plant.sensors import Measurement
from foreride.vehicle.state import VehicleState

_BESIDE_M, _BEYOND_M = 1.0, 2.0
"""Road beside the wheels, and beyond the reach of the map, that rays may meet."""


class RangeScanner:
    """Simulated range sensor: points of the true road in its axes, with its errors."""

    def __init__(self, road: Road, sensor: RangeSensor, drive: Drive, reach_m: float) -> None:
        car = drive.scenario.vehicle.parameters
        rng = drive.random_stream("elevation")
        pitch, roll, bias = rng.standard_normal(3)
        self._sensor, self._rng, self._ahead_m = sensor, rng, max(car.axle_x_m) + reach_m + _BEYOND_M
        nominal = sensor.mount(max(car.axle_x_m))
        self._mount = replace(nominal, pitch_deg=nominal.pitch_deg + sensor.pitch_sigma_deg * float(pitch))
        self._roll_rad = float(np.deg2rad(sensor.roll_sigma_deg * roll))
        self._bias_m = sensor.bias_sigma_m * float(bias)
        sides = min(0.0, *car.wheel_y_m) - _BESIDE_M, max(0.0, *car.wheel_y_m) + _BESIDE_M
        self._grid = HeightGrid(road, *sides)

    def scan(self, state: VehicleState) -> np.ndarray:
        """Points (n, 3) that the sensor measures from the car in this state."""
        sensor, rng = self._sensor, self._rng
        nominal, noise = sensor.directions, rng.standard_normal((len(sensor.directions), 2))
        missing = rng.random(len(nominal)) < sensor.dropout
        true = nominal + np.outer(sensor.direction_sigma_rad * noise[:, 0], [0.0, 0.0, 1.0])
        place = pose(self._mount, state)
        place = replace(place, roll=place.roll + self._roll_rad)
        window = self._grid.window(place.x, float(state.x_m) + self._ahead_m)
        ranges = cast(window, place.position, place.rotation, true, sensor.footprint_rad, sensor.separation)
        ranges[missing | (ranges < sensor.min_range_m) | (ranges > sensor.max_range_m)] = np.nan
        ranges += self._bias_m + sensor.range_sigma_m(ranges) * noise[:, 1]
        seen = np.isfinite(ranges)
        return ranges[seen, None] * nominal[seen]


class ElevationPerception(Perception):
    """Elevation-map perception: scans at the sensor's rate, whose points arrive `latency_s` later."""

    def __init__(
        self, scanner: RangeScanner, sensor: RangeSensor, estimator: ElevationEstimator, car: Car
    ) -> None:
        super().__init__()
        self._frame, self._body = PlaneFrame(car), np.zeros(len(car.corners[0].kinematic_row))
        self._speed_m_s = 0.0
        self._scanner, self._estimator = scanner, estimator
        self._rate_hz, self._latency = sensor.rate_hz, ticks(sensor.latency_s)
        self._pending: deque[tuple[int, np.ndarray]] = deque()
        self._scans = self._points = 0
        self._scan_s: list[float] = []
        self._fusion_s: list[float] = []

    def next_tick(self, tick: int) -> int | None:
        """Tick of the next scan or the next arrival of points."""
        arrivals = [exposed + self._latency for exposed, _ in self._pending]
        return min(next_due(tick, self._rate_hz), *(at for at in arrivals if at > tick), 1 << 62)

    def expose(self, tick: int, state: VehicleState) -> None:
        """Scan if one is due."""
        if due(tick, self._rate_hz):
            start = perf_counter()
            self._pending.append((tick, self._scanner.scan(state)))
            self._scan_s.append(perf_counter() - start)

    def receive(self, tick: int) -> list[Event]:
        """Fuse the points that have arrived."""
        while self._pending and self._pending[0][0] + self._latency <= tick:
            exposed, points = self._pending.popleft()
            start = perf_counter()
            self._estimator.update_points(exposed / TICKS_PER_SECOND, points)
            self._fusion_s.append(perf_counter() - start)
            self._scans, self._points = self._scans + 1, self._points + len(points)
        return []

    def sense(self, measurement: Measurement) -> None:
        """Update the ego motion."""
        self._speed_m_s = measurement.speed_m_s
        self._estimator.update_motion(measurement.time_s, measurement)

    def preview(self, time_s: float, state: VehicleState) -> RoadPreview | None:
        """Return the map's preview, over the plane that the car runs on."""
        return self._frame.of_car(self._estimator.preview(time_s), self._speed_m_s, self._body)

    def stats(self) -> dict[str, Any]:
        """Return counts of scans and points."""
        return {"scans": self._scans, "points": self._points}

    def timing(self) -> dict[str, float]:
        """Return the median run time of simulating a scan, and of fusing it."""
        if not self._fusion_s:
            return {}
        return {
            "scan_median_ms": 1e3 * float(np.median(self._scan_s)),
            "fusion_median_ms": 1e3 * float(np.median(self._fusion_s)),
        }


def build_elevation(drive: Drive, preset: type[RangeSensor] | None = None) -> ElevationPerception:
    """Build an elevation perception of a drive: with the scenario's sensor, or with that of a preset."""
    scenario = drive.scenario
    car, setup = scenario.vehicle.parameters, scenario.elevation
    sensor: RangeSensor = setup.sensor if preset is None else preset()
    estimator = ElevationEstimator(
        sensor,
        car.axle_x_m,
        car.wheel_y_m,
        setup.map,
        scenario.estimator,
        scenario.start_m,
        vehicle_facts(car, scenario.enveloping),
        distance_grid(ahead_m=scenario.preview_m),
    )
    scanner = RangeScanner(scenario.road, sensor, drive, setup.map.reach_m)
    return ElevationPerception(scanner, sensor, estimator, car)


def preset_builder(preset: type[RangeSensor]) -> Callable[[Drive], ElevationPerception]:
    """Builder of the perception with a preset of its sensor."""
    return partial(build_elevation, preset=preset)
