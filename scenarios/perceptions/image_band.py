"""Band of the camera image in which the road lies: rows well above the horizon are not looked at.

The horizon is known from the mounting and the car's own motion. With the car at rest the band begins at least
`detection.above_horizon_deg` above the horizon, at a row of the detector's grid. While the estimated attitude
brings the horizon within `GUARD_DEG` of that row, exposures are looked at whole; so there are two sizes of
images, not one for each attitude.

Obstacles stand on the road, lower than the camera, and so below the horizon: one at 35 m, where tracks begin,
reaches up to 2.1° below it, and still lies inside the band of the default camera behind a change of grade of
7 %.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from foreride.preview.ego_motion.ego_motion import EgoState
from foreride.road.camera.pinhole import Camera, CameraMount, horizon_row, pose_of
from foreride.scenarios.definition.schema import Scenario

if TYPE_CHECKING:  # ONNX Runtime is slow to import
    from foreride.detector.runtime import Detector

GUARD_DEG = 0.5
"""Least angle between horizon and upper edge of the band: errors of the mounting and of the pitch."""
_STEEPEST_DEG = 80.0  # no row of an image lies so far above the horizon


@dataclass(frozen=True)
class ImageBand:
    """Rows of a camera's image from `first_row` on, for a camera mounted as `mount` says."""

    camera: Camera
    mount: CameraMount
    first_row: int

    def at(self, ego: EgoState | None) -> int:
        """First row looked at in an exposure with this ego motion: the band's, or 0 for the whole image.

        ego: None before the first reading, for a car at rest.
        """
        is_inside = self.first_row <= row_above(self.camera, self.mount, GUARD_DEG, ego)
        return self.first_row if is_inside else 0


def image_band(scenario: Scenario, mount: CameraMount, detector: "Detector") -> ImageBand:
    """Band of a scenario's camera, as its estimator believes it mounted."""
    camera = scenario.camera.intrinsics
    row = max(0.0, row_above(camera, mount, scenario.detection.above_horizon_deg))
    return ImageBand(camera, mount, detector.band_row(camera.width_px, camera.height_px, int(row)))


def row_above(camera: Camera, mount: CameraMount, angle_deg: float, ego: EgoState | None = None) -> float:
    """Row this far above the horizon in the middle column; -inf where no row lies so far above it."""
    attitude = (0.0, 0.0, 0.0) if ego is None else (ego.heave_m, ego.pitch_rad, ego.roll_rad)
    pose = pose_of(mount, 0.0, attitude[0], attitude[1] + np.deg2rad(angle_deg), roll=attitude[2])
    if np.rad2deg(pose.pitch) > _STEEPEST_DEG:
        return float("-inf")
    row = horizon_row(camera, pose)
    return float(camera.distort([[camera.cx, row]])[0, 1])


def looked_at(image: np.ndarray | None, first_row: int) -> np.ndarray | None:
    """Copy of an image (H, W, 3) with black rows above `first_row`; the image itself for row 0, or for None.

    Rows that are rendered only to be kept thus have no influence on a drive.
    """
    if image is None or first_row == 0:
        return image
    band = image.copy()
    band[:first_row] = 0
    return band
