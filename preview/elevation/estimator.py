"""Elevation estimator: ego motion and points of a range sensor in, `RoadPreview` out."""

import numpy as np

from foreride.preview.ego_motion.axle_readings import Measurement
from foreride.preview.ego_motion.ego_motion import EgoMotion, EgoState
from foreride.preview.elevation.fusion import ElevationFusion
from foreride.preview.elevation.range_sensor import RangeSensor
from foreride.preview.elevation.settings import ElevationSettings
from foreride.preview.road_preview import RoadPreview
from foreride.preview.settings import Settings
from foreride.preview.vehicle_facts import VehicleFacts
from foreride.road.camera.pinhole import pose_of

Array = np.ndarray


class ElevationEstimator:
    """Estimator of the road ahead of each wheel from the car's sensors and the points of a range sensor.

    sensor: as its data sheet and mounting say. axle_x_m, wheel_y_m: as in `preview.estimator`. settings: of
    the map; motion: of the ego motion. The odometer starts at `x_m`.
    distance_m: grid of the previews.
    """

    def __init__(
        self,
        sensor: RangeSensor,
        axle_x_m: tuple[float, ...],
        wheel_y_m: tuple[float, ...],
        settings: ElevationSettings,
        motion: Settings | None = None,
        x_m: float = 0.0,
        facts: VehicleFacts | None = None,
        distance_m: Array | None = None,
    ) -> None:
        facts = VehicleFacts.typical(len(axle_x_m)) if facts is None else facts
        self.motion = EgoMotion(axle_x_m, motion or Settings(), x_m, wheel_y_m, facts)
        self.fusion = ElevationFusion(sensor, axle_x_m, wheel_y_m, settings, x_m, facts.tyre, distance_m)
        self._mount = sensor.mount(max(axle_x_m))

    def update_motion(self, time_s: float, measurement: Measurement) -> None:
        """Process one set of sensor readings; call at the controller's rate, in order of time."""
        self.motion.update(time_s, measurement)
        if self.motion.turn is not None:
            heave_m, pitch = self.motion.turn
            self.fusion.turn(heave_m - pitch * self._mount.x_m, -pitch)

    def update_points(self, exposure_s: float, points: Array) -> None:
        """Process the points (n, 3), in axes of the sensor (forward, left, up), measured at `exposure_s`."""
        state = self.motion.at(exposure_s)
        self.fusion.add(exposure_s, points, self._pose(state), state.x_m)

    def preview(self, time_s: float) -> RoadPreview:
        """Road preview of each wheel as known at `time_s`."""
        return self.fusion.preview(time_s, self.motion.at(time_s).x_m)

    def _pose(self, state: EgoState) -> tuple[Array, Array]:
        pose = pose_of(self._mount, state.x_m, state.heave_m, state.pitch_rad, roll=state.roll_rad)
        return pose.position, pose.rotation
