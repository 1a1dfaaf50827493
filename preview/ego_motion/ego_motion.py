"""Ego motion at sensor rate: pose history of the sprung mass.

The odometer gives the distance travelled, `preview.ego_motion.heave_pitch_filter` heave and pitch relative to
the road plane, `preview.ego_motion.roll_filter` the roll angle.
"""

from bisect import bisect_right
from typing import NamedTuple

import numpy as np

from foreride.files.errors import InputError
from foreride.preview.ego_motion.axle_readings import AxleReadings, Measurement
from foreride.preview.ego_motion.heave_pitch_filter import HEAVE, PITCH, HeavePitchFilter, PlaneUpdate
from foreride.preview.ego_motion.path import curvature
from foreride.preview.ego_motion.roll_filter import RollFilter
from foreride.preview.settings import Settings
from foreride.preview.vehicle_facts import VehicleFacts

_MAX_FRAME_AGE_S = 0.5  # greatest age of an arriving frame


class EgoState(NamedTuple):
    """State of the sprung mass at one moment, relative to the local road plane.

    x_m: odometer reading. heave_m, pitch_rad (nose-down), roll_rad (left side up): attitude. curvature_1_m:
    of the path, positive to the left.
    """

    time_s: float
    x_m: float
    heave_m: float
    pitch_rad: float
    speed_m_s: float
    roll_rad: float = 0.0
    curvature_1_m: float = 0.0


class EgoMotion:
    """Ego motion: attitude filters (`preview.ego_motion.heave_pitch_filter`,
    `preview.ego_motion.roll_filter`), odometer, and their recent history.

    axle_x_m: position of each wheel relative to the centre of gravity, front first (one for a quarter
    car, which has no pitch). wheel_y_m: their lateral positions, for a car that can roll. facts: of the car,
    by default those of a compact car. The odometer starts at `x_m` and reads the centre of gravity.
    """

    def __init__(
        self,
        axle_x_m: tuple[float, ...],
        settings: Settings,
        x_m: float = 0.0,
        wheel_y_m: tuple[float, ...] | None = None,
        facts: VehicleFacts | None = None,
    ) -> None:
        facts = facts or VehicleFacts.typical(len(axle_x_m))
        self._readings = AxleReadings(axle_x_m, facts.tyre_compliance)
        self.settings = settings
        self.x_m = x_m
        axles = self._readings.positions_m
        self._front_m = float(axles[0]) if len(axles) > 1 else 0.0  # a quarter car has no pitch
        self._body = HeavePitchFilter(axles, settings)
        self._roll = RollFilter(axle_x_m, wheel_y_m or (0.0,) * len(axle_x_m), settings)
        self._last_inertial: tuple[float, float, float] | None = None
        self.road_m = 0.0
        self.turn: PlaneUpdate | None = None  # update of the road plane by the last `update`
        self._masked_until_s = -np.inf
        self._times: list[float] = []
        self._states: list[EgoState] = []

    def update(
        self, time_s: float, measurement: Measurement, on_plane: bool = True, yaw_rate: float = 0.0
    ) -> EgoState:
        """Process one measurement; time must advance, else `InputError`.

        on_plane: False while a wheel is known to be on an object, and so off the road plane. yaw_rate: rad/s,
        positive to the left.
        """
        previous, speed = self.newest, measurement.speed_m_s
        step = 0.0 if previous is None else time_s - previous.time_s
        if previous is not None:
            if step <= 0:
                raise InputError(f"time_s must advance beyond {previous.time_s}, got {time_s}")
            self.x_m += step * 0.5 * (previous.speed_m_s + speed)
        if max(map(abs, measurement.wheel_acc.tolist())) > self.settings.strike_acc_m_s2:
            self._masked_until_s = time_s + self.settings.strike_hold_s
        acceleration, deflection, wheel_deflection = self._readings.of(measurement)
        self._predict(step, acceleration, measurement.pitch_rate, measurement.roll_rate)
        self.turn = None
        if on_plane and time_s >= self._masked_until_s:
            self.turn = self._body.level(deflection, step, speed)
            if self.turn is not None:
                self._transform_history(self.turn)
            self._roll.level(wheel_deflection, self._body.roughness_m)
        heave, pitch = float(self._body.state[HEAVE]), float(self._body.state[PITCH])
        self.road_m = heave - self._front_m * pitch - float(deflection[0])
        path_curvature = curvature(yaw_rate, speed)
        state = EgoState(time_s, self.x_m, heave, pitch, speed, self._roll.roll_rad, path_curvature)
        self._times.append(state.time_s)
        self._states.append(state)
        if len(self._times) > 2 and self._times[0] < state.time_s - 2 * self.settings.history_s:
            keep = bisect_right(self._times, state.time_s - self.settings.history_s)
            del self._times[:keep], self._states[:keep]
        return state

    def _predict(self, step: float, *inertial: float) -> None:
        """Prediction with the means of this and the last acceleration, pitch rate and roll rate."""
        acceleration, pitch_rate, roll_rate = inertial
        last_acceleration, last_pitch_rate, last_roll_rate = self._last_inertial or inertial
        self._body.predict(
            step, 0.5 * (acceleration + last_acceleration), 0.5 * (pitch_rate + last_pitch_rate)
        )
        self._roll.predict(step, 0.5 * (roll_rate + last_roll_rate))
        self._last_inertial = acceleration, pitch_rate, roll_rate

    @property
    def newest(self) -> EgoState | None:
        """State after the last measurement; None before the first."""
        return self._states[-1] if self._states else None

    def at(self, time_s: float) -> EgoState:
        """State at any recent moment, interpolated between measurements.

        After the newest one it is extrapolated at constant speed; before any measurement, or before the
        history, `InputError`.
        """
        if not self._states:
            raise InputError("time_s must follow a first measurement, got no measurement yet")
        newest = self._states[-1]
        if time_s == newest.time_s:
            return newest
        if time_s > newest.time_s:
            x_m = newest.x_m + (time_s - newest.time_s) * newest.speed_m_s
            attitude = newest.heave_m, newest.pitch_rad, newest.speed_m_s, newest.roll_rad
            return EgoState(time_s, x_m, *attitude, newest.curvature_1_m)
        if time_s < self._times[0] - 1e-9:
            raise InputError(f"time_s must be >= {self._times[0]} (start of the history), got {time_s}")
        index = max(1, bisect_right(self._times, time_s))
        a, b = self._states[index - 1], self._states[index]
        share = (time_s - a.time_s) / (b.time_s - a.time_s)

        def interpolate(p: float, q: float) -> float:
            return p + share * (q - p)

        return EgoState(
            time_s,
            interpolate(a.x_m, b.x_m),
            interpolate(a.heave_m, b.heave_m),
            interpolate(a.pitch_rad, b.pitch_rad),
            interpolate(a.speed_m_s, b.speed_m_s),
            interpolate(a.roll_rad, b.roll_rad),
            interpolate(a.curvature_1_m, b.curvature_1_m),
        )

    @property
    def grade_sigma(self) -> float:
        """Standard deviation of the grade ahead after a detected change of grade."""
        return self._body.grade_sigma

    def _transform_history(self, turn: PlaneUpdate) -> None:
        """Transform the recent states to the updated plane, for frames exposed then that may yet arrive."""
        first = bisect_right(self._times, self._times[-1] - _MAX_FRAME_AGE_S)
        for k in range(first, len(self._times)):
            old = self._states[k]
            heave = old.heave_m + turn.heave_m + (self.x_m - old.x_m) * turn.pitch_rad
            self._states[k] = old._replace(heave_m=heave, pitch_rad=old.pitch_rad + turn.pitch_rad)
