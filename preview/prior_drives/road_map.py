"""Map-based road preview: measured road heights with their uncertainty, from a file.

Any source that knows the road's surface can supply it (LiDAR, a survey, a cloud service, other cars): as
CSV with one line per station,

    x_m,left_m,right_m,height_sigma_m,position_sigma_m,existence
    0.00,0.0000,0.0000,0.004,0.05,1
    0.05,0.0004,0.0001,0.004,0.05,1

where the height columns are those of `road.io.readers.csv_profile` and the last three are optional, or as
ASAM OpenCRG, which has no uncertainty.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from foreride.files.errors import InputError, shortened
from foreride.preview.road_preview import RoadPreview, distance_grid
from foreride.road.io.readers import csv_profile, opencrg
from foreride.road.io.surface_file import MeasuredSurface, surface
from foreride.road.tyre.contact_models import Enveloping, RigidWheel
from foreride.road.tyre.wheel_profile import PATCH_M, STEP_M, WheelProfile

Array = np.ndarray
_UNCERTAINTY_COLUMNS = {"height_sigma_m": 0.01, "position_sigma_m": 0.05, "existence": 1.0}
"""Columns of the map's uncertainty, with their default values."""
_ENDINGS = (".csv", ".crg")
_UPPER_LIMITS = {"height_sigma_m": 10.0, "position_sigma_m": 1000.0, "existence": 1.0}


@dataclass(frozen=True)
class RoadMap:
    """Road map: heights by station, with uncertainty; stations are odometer positions.

    surface: heights over x and y, x from the first station, which is at `start_m`. height_sigma_m,
    position_sigma_m, existence: (n,) at `surface.x_m`, as in `RoadPreview`.
    """

    surface: MeasuredSurface
    height_sigma_m: Array
    position_sigma_m: Array
    existence: Array
    start_m: float = 0.0

    def __post_init__(self) -> None:
        for name in _UNCERTAINTY_COLUMNS:
            values = getattr(self, name)
            if values.shape != self.surface.x_m.shape:
                raise InputError(f"{name} must have one value per station, got shape {values.shape}")
            upper = _UPPER_LIMITS[name]
            if not ((values >= 0) & (values <= upper)).all():
                first_outside = values[~((values >= 0) & (values <= upper))][0]
                raise InputError(f"{name} must lie in 0 ... {upper:g}, got {first_outside:g}")


def read(path: Path | str) -> RoadMap:
    """Map of a .csv or .crg file. Raises InputError naming the file and the fault."""
    path = Path(path)
    if path.suffix.lower() not in _ENDINGS:
        raise InputError(f"{path}: a map must end in {' or '.join(_ENDINGS)}")
    if path.suffix.lower() == ".crg":
        raw = opencrg.read(path)
        quality_columns = {}
    else:
        header, table = csv_profile.read_table(path)
        if duplicates := sorted({name for name in header if header.count(name) > 1}):
            raise InputError(
                f"{path}: each column must be named once, got {shortened(', '.join(duplicates))} twice"
            )
        height_columns = [k for k, name in enumerate(header) if name not in _UNCERTAINTY_COLUMNS]
        raw = csv_profile.profile_of(path, [header[k] for k in height_columns], table[:, height_columns])
        quality_columns = {
            name: table[:, header.index(name)] for name in _UNCERTAINTY_COLUMNS if name in header
        }
    quality = {
        name: quality_columns.get(name, np.full(len(raw.x), default))
        for name, default in _UNCERTAINTY_COLUMNS.items()
    }
    if raw.by_time:
        raise InputError(f"{path}: a map must have stations x_m, not times")
    loaded = surface(raw.x, raw.y_m, raw.heights, str(path))
    try:
        return RoadMap(loaded, **quality, start_m=float(raw.x[0]))
    except InputError as error:
        raise InputError(f"{path}: {error}") from None


def wheel_tracks(
    road_map: RoadMap, wheel_y_m: Sequence[float], radius_m: float, enveloping: Enveloping | None = None
) -> list[WheelProfile]:
    """Effective heights of the map on each wheel track, for a tyre of this radius."""
    x = np.arange(0.0, road_map.surface.length_m + STEP_M / 2, STEP_M)  # from the first station
    tyre = RigidWheel(PATCH_M) if enveloping is None else enveloping
    heights = (road_map.surface.height(x, y) for y in wheel_y_m)
    return [
        WheelProfile(road_map.start_m, STEP_M, tyre.effective_height(z, STEP_M, radius_m)) for z in heights
    ]


def map_preview(
    road_map: RoadMap,
    tracks: Sequence[WheelProfile],
    wheel_x_m: Array,
    localisation_sigma_m: float,
    time_s: float,
    distance_m: Array | None = None,
) -> RoadPreview:
    """Preview of the map ahead of wheels at estimated positions `wheel_x_m` (sigma `localisation_sigma_m`).

    Beyond the ends of the map the road is flat and nothing is known: existence 0.
    """
    distance = distance_grid() if distance_m is None else distance_m
    x_m = np.asarray(wheel_x_m, float)[:, None] + distance
    stations = road_map.start_m + road_map.surface.x_m
    on_map = (x_m >= stations[0]) & (x_m <= stations[-1])

    def interpolated(values: Array) -> Array:
        return np.where(on_map, np.interp(x_m, stations, values), 0.0)

    height = np.stack([track.height(x) for track, x in zip(tracks, x_m, strict=True)])
    return RoadPreview(
        time_s,
        distance,
        height,
        np.hypot(interpolated(road_map.position_sigma_m), localisation_sigma_m),
        interpolated(road_map.height_sigma_m),
        interpolated(road_map.existence),
    )
