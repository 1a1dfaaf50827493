"""Map perception (`map`): preview from a road map at the car's estimated position on it."""

from collections.abc import Sequence

import numpy as np

from foreride.files.errors import InputError
from foreride.preview.prior_drives.road_map import RoadMap, map_preview, read, wheel_tracks
from foreride.preview.road_preview import RoadPreview
from foreride.road.tyre.wheel_profile import WheelProfile
from foreride.scenarios.definition.schema import Scenario
from foreride.scenarios.perceptions.interface import Drive, Perception, ReferencedFile
from foreride.scenarios.perceptions.plane_frame import PlaneFrame
from foreride.vehicle.load import Car
from foreride.vehicle.state import VehicleState


class MapPerception(Perception):
    """Perception from a road map, with a constant localisation error `error_m` over the drive."""

    def __init__(
        self, road_map: RoadMap, tracks: Sequence[WheelProfile], car: Car, sigma_m: float, error_m: float
    ) -> None:
        super().__init__()
        self._map, self._tracks = road_map, tracks
        self._sigma_m, self._error_m = sigma_m, error_m
        self._axles, self._frame = np.asarray(car.axle_x_m), PlaneFrame(car)

    def preview(self, time_s: float, state: VehicleState) -> RoadPreview:
        """Return the mapped road ahead of the wheels."""
        wheels = float(state.x_m) + self._error_m + self._axles
        mapped = map_preview(self._map, self._tracks, wheels, self._sigma_m, time_s)
        return self._frame.relative(mapped, state)


def read_map(scenario: Scenario) -> tuple[RoadMap, float]:
    """Map of a scenario and the localisation standard deviation, m; InputError without a map."""
    if scenario.map is None:
        raise InputError(f"{scenario.name}: perception map needs the field map with a file, got none")
    return read(scenario.map.file), scenario.map.localisation_sigma_m


MAP = ReferencedFile(
    "map_sha256", lambda scenario: None if scenario.map is None else scenario.map.file, read_map
)
"""The road map of a scenario."""


def build_map(drive: Drive) -> MapPerception:
    """Build the perception `map` of a drive, with a localisation error drawn once."""
    scenario, car = drive.scenario, drive.scenario.vehicle.parameters
    known, sigma = read_map(scenario)
    tracks = wheel_tracks(known, car.wheel_y_m, car.wheel_radius_m, scenario.enveloping)
    error_m = sigma * float(drive.random_stream("map").standard_normal())
    return MapPerception(known, tracks, car, sigma, error_m)
