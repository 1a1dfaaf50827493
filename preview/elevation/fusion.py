"""Elevation fusion: points of a range sensor, with its assumed poses, to a map and previews."""

import numpy as np

from foreride.preview.elevation.height_map import HeightMap, ScanCells
from foreride.preview.elevation.range_sensor import RangeSensor
from foreride.preview.elevation.scan_registration import ScanRegistration
from foreride.preview.elevation.settings import ElevationSettings
from foreride.preview.elevation.track_profile import fitted_line, smoothed
from foreride.preview.road_preview import RoadPreview, distance_grid
from foreride.road.tyre.tyre import Tyre

Array = np.ndarray
_BEHIND_M, _BESIDE_M = 1.5, 0.6
"""Map behind the rear axle, and beside the outer wheels."""
_MIN_CELLS = 20


class ElevationFusion:
    """Map around the car, and the effective heights of its wheels' tracks.

    axle_x_m, wheel_y_m: of the wheels, from the centre of gravity, whose odometer starts at `x_m`.
    distance_m: grid of the previews.
    """

    def __init__(
        self,
        sensor: RangeSensor,
        axle_x_m: tuple[float, ...],
        wheel_y_m: tuple[float, ...],
        settings: ElevationSettings,
        x_m: float,
        tyre: Tyre,
        distance_m: Array | None = None,
    ) -> None:
        self._sensor, self._settings, self._tyre = sensor, settings, tyre
        self.axle_x_m, self.wheel_y_m = np.asarray(axle_x_m, float), np.asarray(wheel_y_m, float)
        self._distance_m = distance_grid() if distance_m is None else distance_m
        self._behind_m = _BEHIND_M - min(axle_x_m)
        length_m = self._behind_m + max(axle_x_m) + settings.reach_m
        sides = min(0.0, *wheel_y_m) - _BESIDE_M, max(0.0, *wheel_y_m) + _BESIDE_M
        self.map = HeightMap(x_m - self._behind_m, length_m, *sides, settings)
        self.registration = ScanRegistration(settings)
        self._profiles: tuple[Array, Array, Array] | None = None
        self._newest_s = -np.inf

    def add(self, time_s: float, points: Array, pose: tuple[Array, Array], x_m: float) -> None:
        """Process a scan: points (n, 3) in axes of the sensor, its assumed position (3,) and rotation (3, 3).

        x_m: odometer reading at the scan.
        """
        position, rotation = pose
        self.map.move(x_m - self._behind_m)
        offset = points @ rotation.T
        cells = self.map.cells_of(
            offset + position, self._variance_m2(points, offset), self._settings.cell_sigma_m**2
        )
        self._newest_s = max(self._newest_s, time_s)
        self._profiles = None
        if len(cells.rows) < _MIN_CELLS:
            return
        middles = self.map.x_m[cells.rows] - position[0], self.map.y_m[cells.columns] - position[1]
        self._insert(cells, np.stack([np.ones(len(cells.rows)), *middles], axis=1))

    def _insert(self, cells: ScanCells, rows: Array) -> None:
        """Register a scan to the map, and update its cells; rows: (n, 3) heights per unit of error."""
        map_m, map_m2 = self.map.known(cells)
        known, registration = np.isfinite(map_m2), self.registration
        if known.any():
            departure, spread = cells.height_m - map_m, cells.variance_m2 + map_m2
            registration.update(rows[known], departure[known], spread[known])
        height_m = cells.height_m - rows @ registration.error
        left_m2 = np.einsum("ki,ij,kj->k", rows, registration.covariance, rows)
        self.map.update(cells._replace(height_m=height_m, variance_m2=cells.variance_m2 + left_m2))

    def turn(self, heave_m: float, slope: float) -> None:
        """Change of the plane of the assumed poses: heights at the sensor, and their slope along the road."""
        self.registration.shift(np.array([heave_m, slope, 0.0]))

    def preview(self, time_s: float, x_m: float) -> RoadPreview:
        """Preview of each wheel at this reading of the odometer."""
        stations, heights, sigmas = self._tracks()
        distance = self._distance_m
        x = x_m + self.axle_x_m[:, None] + distance
        height = np.stack([np.interp(at, stations, row) for at, row in zip(x, heights, strict=True)])
        sigma = np.stack([np.interp(at, stations, row) for at, row in zip(x, sigmas, strict=True)])
        existence = np.clip(1.0 - (sigma / self._settings.road_sigma_m) ** 2, 0.0, 1.0)
        position = np.hypot(0.5 * self._settings.cell_m, self._settings.odometry_sigma * np.abs(distance))
        age = max(time_s - self._newest_s, 0.0) if np.isfinite(self._newest_s) else 0.0
        return RoadPreview(time_s, distance, height, np.tile(position, (len(x), 1)), sigma, existence, age)

    def _tracks(self) -> tuple[Array, Array, Array]:
        """Stations (n,), effective heights and standard deviations (wheels, n) of all tracks."""
        if self._profiles is None:
            by_y = {y: self._track(y) for y in dict.fromkeys(self.wheel_y_m.tolist())}
            heights, sigmas = (np.stack([by_y[y][k] for y in self.wheel_y_m.tolist()]) for k in (0, 1))
            self._profiles = self.map.x_m, heights, sigmas
        return self._profiles

    def _track(self, y_m: float) -> tuple[Array, Array]:
        settings = self._settings
        measured, variance = self.map.strip(y_m, settings.tyre_width_m)
        line = fitted_line(measured, variance, settings)
        height, variance = smoothed(measured - line, variance, settings)
        return line + self._tyre.effective_height(height, settings.cell_m), np.sqrt(variance)

    def _variance_m2(self, points: Array, offset: Array) -> Array:
        """Variance (n,) of the heights of points with these offsets from the sensor, in axes of the road."""
        distance = np.maximum(np.linalg.norm(points, axis=1), 1e-6)
        along = self._sensor.range_sigma_m(distance) * offset[:, 2] / distance
        across = self._sensor.direction_sigma_rad * np.hypot(offset[:, 0], offset[:, 1])
        return np.asarray(along**2 + across**2 + 1e-8)
