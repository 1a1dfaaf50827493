"""Range sensors: directions of the measurements and their errors, by the data sheets of LiDAR and stereo.

Sources of the presets:

* lidar_64: spinning LiDAR with 64 beams; Velodyne HDL-64E S3, user's manual 63-HDL64ES3: 26.9° from +2.0° to
  -24.9°, 0.17° of azimuth at 10 Hz, < 2 cm (one sigma), 2 mrad; angular error after calibration: Glennie &
  Lichti, Remote Sensing 2(6), 2010. On the roof at 1.73 m, as in Geiger et al., Int. J. Robotics Research
  32(11), 2013.
* lidar_solid_state: forward LiDAR behind the windscreen; Livox HAP (TX), user manual 2022: 120° x 25°, 452
  000 points/s, 10 Hz, < 2 cm at 20 m and < 0.1° (one sigma), beam 0.03° x 0.28°.
* stereo_30cm: pair of 1280 x 960 px over 50° (of automotive stereo video cameras), 30 cm apart; disparity
  error of semi-global matching, 0.2 px of each window: Hirschmüller & Gehrig, IEEE CVPR 2009.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Annotated, ClassVar

import numpy as np
from annotated_types import Interval

from foreride.files.errors import InputError
from foreride.files.reading.ranges import Checked, Share
from foreride.road.camera.pinhole import CameraMount

Array = np.ndarray
MAX_RAYS = 200_000
Angle = Annotated[float, Interval(ge=-90.0, le=90.0), "degrees"]
AngleStep = Annotated[float, Interval(ge=0.01, le=10.0), "degrees"]
AngleSigma = Annotated[float, Interval(ge=0.0, le=5.0), "degrees"]
LengthSigma = Annotated[float, Interval(ge=0.0, le=1.0), "m"]
Distance = Annotated[float, Interval(ge=0.1, le=300.0), "m"]


@dataclass(frozen=True)
class RangeSensor(Checked):
    """Mounting, rate and errors that all range sensors have.

    The sensor is `behind_front_axle_m` behind the front axle. bias_sigma_m, pitch_sigma_deg, roll_sigma_deg:
    constant errors of range and mounting, drawn once per drive. dropout: share of measurements that are
    missing. min_range_m, max_range_m: of measurements. latency_s: from exposure to points.
    """

    height_m: Annotated[float, Interval(ge=0.2, le=4.0), "m"] = 1.3
    behind_front_axle_m: Annotated[float, Interval(ge=-1.5, le=5.0), "m"] = 1.6
    pitch_deg: Annotated[float, Interval(ge=-10.0, le=45.0), "degrees"] = 0.0
    rate_hz: Annotated[int, Interval(ge=1, le=100), "Hz"] = 10
    latency_s: Annotated[float, Interval(ge=0.0, le=1.0), "s"] = 0.05
    dropout: Share = 0.02
    bias_sigma_m: LengthSigma = 0.0
    pitch_sigma_deg: AngleSigma = 0.1
    roll_sigma_deg: AngleSigma = 0.1
    min_range_m: Distance = 0.5
    max_range_m: Distance = 100.0

    def __post_init__(self) -> None:
        super().__post_init__()
        if not self.min_range_m < self.max_range_m:
            raise InputError(
                f"max_range_m must be > min_range_m = {self.min_range_m:g} m, got {self.max_range_m:g}"
            )
        if not 0 < len(self.azimuths_rad) * len(self.elevations_rad) <= MAX_RAYS:
            raise InputError(
                f"field of view and steps must give 1 ... {MAX_RAYS} directions, got "
                f"{len(self.azimuths_rad)} x {len(self.elevations_rad)}"
            )

    @property
    def azimuths_rad(self) -> Array:
        """Azimuths of the measurements, positive to the left."""
        raise NotImplementedError

    @property
    def elevations_rad(self) -> Array:
        """Elevations of the measurements, positive upwards."""
        raise NotImplementedError

    @property
    def footprint_rad(self) -> float:
        """Vertical angle over which one measurement averages."""
        raise NotImplementedError

    @property
    def separation(self) -> tuple[float, float]:
        """Distance a + b r² (m, 1/m) between two surfaces from which on only the nearer is measured."""
        raise NotImplementedError

    @property
    def direction_sigma_rad(self) -> float:
        """Standard deviation of the elevation of a measurement."""
        raise NotImplementedError

    def range_sigma_m(self, range_m: Array) -> Array:
        """Standard deviation of a measured range."""
        raise NotImplementedError

    @cached_property
    def directions(self) -> Array:
        """(n, 3) unit vectors of all measurements in axes of the sensor: forward, left, up."""
        azimuth, elevation = (
            part.ravel() for part in np.meshgrid(self.azimuths_rad, self.elevations_rad, indexing="ij")
        )
        flat = np.cos(elevation)
        return np.stack([flat * np.cos(azimuth), flat * np.sin(azimuth), np.sin(elevation)], axis=1)

    def mount(self, front_axle_m: float) -> CameraMount:
        """Nominal mounting relative to the centre of gravity of a car with this front axle."""
        return CameraMount(front_axle_m - self.behind_front_axle_m, self.height_m, self.pitch_deg)


def _steps(low_deg: float, high_deg: float, step_deg: float) -> Array:
    count = int(np.floor((high_deg - low_deg) / step_deg + 1e-9)) + 1
    return np.deg2rad(low_deg + step_deg * np.arange(max(count, 0)))


@dataclass(frozen=True)
class Lidar(RangeSensor):
    """LiDAR: a grid of beams, ranges with a constant standard deviation.

    azimuth_deg: half width of the sector ahead that is used. elevation_min_deg, elevation_max_deg: vertical
    field. azimuth_step_deg, elevation_step_deg: resolution. beam_deg: vertical divergence of a beam.
    angle_sigma_deg: of its elevation. pulse_m: length of a pulse in the road, within which echoes merge.
    """

    azimuth_deg: Annotated[float, Interval(ge=1.0, le=60.0), "degrees"] = 25.0
    azimuth_step_deg: AngleStep = 0.2
    elevation_min_deg: Angle = -25.0
    elevation_max_deg: Angle = 0.0
    elevation_step_deg: AngleStep = 0.4
    range_noise_m: LengthSigma = 0.02
    angle_sigma_deg: AngleSigma = 0.05
    beam_deg: Annotated[float, Interval(ge=0.0, le=2.0), "degrees"] = 0.1
    pulse_m: Annotated[float, Interval(ge=0.0, le=10.0), "m"] = 0.5

    @property
    def azimuths_rad(self) -> Array:
        """Azimuths of the beams."""
        return _steps(-self.azimuth_deg, self.azimuth_deg, self.azimuth_step_deg)

    @property
    def elevations_rad(self) -> Array:
        """Elevations of the beams."""
        return _steps(self.elevation_min_deg, self.elevation_max_deg, self.elevation_step_deg)

    @property
    def footprint_rad(self) -> float:
        """Divergence of a beam."""
        return float(np.deg2rad(self.beam_deg))

    @property
    def separation(self) -> tuple[float, float]:
        """Length of a pulse."""
        return self.pulse_m, 0.0

    @property
    def direction_sigma_rad(self) -> float:
        """Standard deviation of a beam's elevation."""
        return float(np.deg2rad(self.angle_sigma_deg))

    def range_sigma_m(self, range_m: Array) -> Array:
        """Constant standard deviation."""
        return np.full_like(range_m, self.range_noise_m)


@dataclass(frozen=True)
class Lidar64(Lidar):
    """Spinning LiDAR with 64 beams on the roof (Velodyne HDL-64E S3)."""

    kind: ClassVar[str] = "lidar_64"
    label: ClassVar[str] = "LiDAR with 64 beams"
    height_m: Annotated[float, Interval(ge=0.2, le=4.0), "m"] = 1.73
    azimuth_step_deg: AngleStep = 0.1728
    elevation_min_deg: Angle = -24.9
    elevation_max_deg: Angle = 2.0
    elevation_step_deg: AngleStep = 0.4269
    angle_sigma_deg: AngleSigma = 0.02
    beam_deg: Annotated[float, Interval(ge=0.0, le=2.0), "degrees"] = 0.115
    min_range_m: Distance = 0.9
    max_range_m: Distance = 50.0


@dataclass(frozen=True)
class LidarSolidState(Lidar):
    """Forward LiDAR behind the windscreen (Livox HAP)."""

    kind: ClassVar[str] = "lidar_solid_state"
    label: ClassVar[str] = "solid-state LiDAR"
    height_m: Annotated[float, Interval(ge=0.2, le=4.0), "m"] = 1.4
    pitch_deg: Annotated[float, Interval(ge=-10.0, le=45.0), "degrees"] = 10.0
    azimuth_step_deg: AngleStep = 0.2
    elevation_min_deg: Angle = -12.5
    elevation_max_deg: Angle = 12.5
    elevation_step_deg: AngleStep = 0.33
    angle_sigma_deg: AngleSigma = 0.1
    beam_deg: Annotated[float, Interval(ge=0.0, le=2.0), "degrees"] = 0.28
    max_range_m: Distance = 150.0


@dataclass(frozen=True)
class Stereo30cm(RangeSensor):
    """Stereo camera with a base of 30 cm: one depth for each matching window.

    base_m: baseline. disparity_sigma_px: of a window. width_px, height_px: of an image. window_columns_px,
    window_rows_px: of a matching window.
    """

    kind: ClassVar[str] = "stereo_30cm"
    label: ClassVar[str] = "stereo camera, base 30 cm"
    pitch_deg: Annotated[float, Interval(ge=-10.0, le=45.0), "degrees"] = 6.0
    rate_hz: Annotated[int, Interval(ge=1, le=100), "Hz"] = 20
    min_range_m: Distance = 2.0
    base_m: Annotated[float, Interval(ge=0.05, le=1.0), "m"] = 0.3
    focal_px: Annotated[float, Interval(ge=100.0, le=10_000.0), "px"] = 1373.0
    disparity_sigma_px: Annotated[float, Interval(ge=0.01, le=5.0), "px"] = 0.2
    width_px: Annotated[int, Interval(ge=64, le=8192), "px"] = 1280
    height_px: Annotated[int, Interval(ge=64, le=8192), "px"] = 960
    window_columns_px: Annotated[int, Interval(ge=1, le=65), "px"] = 9
    window_rows_px: Annotated[int, Interval(ge=1, le=65), "px"] = 3

    @property
    def azimuths_rad(self) -> Array:
        """Azimuths of the windows' columns."""
        return np.arctan(_offsets(self.width_px, self.window_columns_px) / self.focal_px)

    @property
    def elevations_rad(self) -> Array:
        """Elevations of the windows' rows, those that see the road."""
        every = np.arctan(_offsets(self.height_px, self.window_rows_px) / self.focal_px)
        return every[every < np.deg2rad(self.pitch_deg) - 0.03]

    @property
    def footprint_rad(self) -> float:
        """Vertical angle of a window."""
        return self.window_rows_px / self.focal_px

    @property
    def separation(self) -> tuple[float, float]:
        """Depth of one pixel of disparity: matching keeps jumps of depth apart."""
        return 0.0, 1.0 / (self.focal_px * self.base_m)

    @property
    def direction_sigma_rad(self) -> float:
        """Zero: pixels know their direction."""
        return 0.0

    def range_sigma_m(self, range_m: Array) -> Array:
        """Standard deviation z² sigma_d / (f B), of depth z."""
        return range_m**2 * (self.disparity_sigma_px / (self.focal_px * self.base_m))


def _offsets(pixels: int, window: int) -> Array:
    """Centres of windows side by side over so many pixels, relative to the middle, px."""
    count = pixels // window
    return window * (np.arange(count) - 0.5 * (count - 1))


Sensor = Lidar64 | LidarSolidState | Stereo30cm
PRESETS: tuple[type[Sensor], ...] = (Lidar64, LidarSolidState, Stereo30cm)
