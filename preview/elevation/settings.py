"""Settings of the elevation map: cells, prior of the road and of the errors of a scan."""

from dataclasses import dataclass
from typing import Annotated

from annotated_types import Interval

from foreride.files.reading.ranges import Checked

HeightSigma = Annotated[float, Interval(ge=1e-5, le=1.0), "m"]
AngleSigma = Annotated[float, Interval(ge=1e-4, le=5.0), "degrees"]


@dataclass(frozen=True)
class ElevationSettings(Checked):
    """Settings of the elevation map.

    cell_m: length of a cell along the road. column_m: width of a cell. reach_m: length of the map ahead of
    the front axle. road_sigma_m, road_length_m: standard deviation and correlation length of the road over
    its plane, where nothing was measured. cell_sigma_m: noise of a cell's height in one scan beyond that of
    its points. heave_sigma_m, tilt_sigma_deg: change of the ego motion's errors of heave, pitch and roll from
    scan to scan. tyre_width_m: width of the road under a tyre. odometry_sigma: relative error of travelled
    distance.
    """

    cell_m: Annotated[float, Interval(ge=0.01, le=0.5), "m"] = 0.05
    column_m: Annotated[float, Interval(ge=0.02, le=1.0), "m"] = 0.1
    reach_m: Annotated[float, Interval(ge=2.0, le=60.0), "m"] = 12.0
    road_sigma_m: HeightSigma = 0.02
    road_length_m: Annotated[float, Interval(ge=0.05, le=100.0), "m"] = 2.0
    cell_sigma_m: HeightSigma = 0.001
    heave_sigma_m: HeightSigma = 0.005
    tilt_sigma_deg: AngleSigma = 0.1
    tyre_width_m: Annotated[float, Interval(ge=0.02, le=1.0), "m"] = 0.2
    odometry_sigma: Annotated[float, Interval(ge=1e-6, le=0.5), "1"] = 0.005
