"""Ego motion at sensor rate: pose history of the sprung mass.

The odometer gives the distance travelled, `preview.ego_motion.heave_pitch_filter` heave and pitch relative to
the road plane, `preview.ego_motion.roll_filter` the roll angle.
"""

from bisect import bisect_right
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from foreride.files.errors import InputError
from foreride.preview.ego_motion.heave_pitch_filter import HEAVE, PITCH, HeavePitchFilter, PlaneUpdate
from foreride.preview.ego_motion.path import curvature
from foreride.preview.ego_motion.roll_filter import RollFilter
from foreride.preview.settings import Settings
from foreride.preview.vehicle_facts import VehicleFacts

_MAX_FRAME_AGE_S = 0.5  # greatest age of an arriving frame


class Measurement(Protocol):
    """Sensor readings of the car at one moment; one entry per wheel, front first."""

    @property
    def body_acc(self) -> np.ndarray:
        """Vertical acceleration of the body over each wheel, without gravity, m/s²."""

    @property
    def wheel_acc(self) -> np.ndarray:
        """Vertical acceleration of each wheel, m/s²."""

    @property
    def rattle_m(self) -> np.ndarray:
        """Rattle space: body minus wheel height, m, deviation from rest."""

    @property
    def pitch_rate(self) -> float:
        """Pitch rate, positive nose-down, rad/s."""

    @property
    def roll_rate(self) -> float:
        """Rate of roll, positive left side up, rad/s; 0 for a car without roll."""

    @property
    def speed_m_s(self) -> float:
        """Speed along the road, m/s."""


@dataclass(frozen=True)
class EgoState:
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
    car, which has no pitch); wheels at the same place share an axle, which moves by their mean. wheel_y_m:
    their lateral positions, for a car that can roll. facts: of the car, by default those of a compact car.
    The odometer starts at `x_m` and reads the centre of gravity.
    """

    def __init__(
        self,
        axle_x_m: tuple[float, ...],
        settings: Settings,
        x_m: float = 0.0,
        wheel_y_m: tuple[float, ...] | None = None,
        facts: VehicleFacts | None = None,
    ) -> None:
        axles = sorted(set(axle_x_m), reverse=True)
        if len(axles) not in (1, 2):
            raise InputError(f"axle_x_m must name 1 or 2 axles, got {len(axles)}")
        self.axle_x_m = np.asarray(axles, dtype=float)
        self._wheels_of_axle = [[wheel for wheel, at in enumerate(axle_x_m) if at == x] for x in axles]
        self.settings = settings
        self.x_m = x_m
        self._tyre_compliance = (facts or VehicleFacts.typical(len(axle_x_m))).tyre_compliance
        self._body = HeavePitchFilter(self.axle_x_m, settings)
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
        previous = self._states[-1] if self._states else None
        step = 0.0 if previous is None else time_s - previous.time_s
        if previous is not None:
            if step <= 0:
                raise InputError(f"time_s must advance beyond {previous.time_s}, got {time_s}")
            self.x_m += step * 0.5 * (previous.speed_m_s + measurement.speed_m_s)
        if max(map(abs, measurement.wheel_acc.tolist())) > self.settings.strike_acc_m_s2:
            self._masked_until_s = time_s + self.settings.strike_hold_s
        self.turn = None
        use_plane = on_plane and time_s >= self._masked_until_s
        inertial = self._at_centre(measurement.body_acc), measurement.pitch_rate, measurement.roll_rate
        acceleration, pitch_rate, roll_rate = (
            0.5 * (now + last) for now, last in zip(inertial, self._last_inertial or inertial, strict=True)
        )
        self._body.predict(step, acceleration, pitch_rate)
        self._roll.predict(step, roll_rate)
        self._last_inertial = inertial
        wheel_deflection = self._deflection(measurement)
        deflection = np.array(self._over_axles(wheel_deflection))
        if use_plane:
            self.turn = self._body.level(deflection, step, measurement.speed_m_s)
            if self.turn is not None:
                self._transform_history(self.turn)
            self._roll.level(wheel_deflection, self._body.roughness_m)
        self.road_m = float(self._body.road_m(deflection)[0])
        heave, pitch = float(self._body.state[HEAVE]), float(self._body.state[PITCH])
        path_curvature = curvature(yaw_rate, measurement.speed_m_s)
        state = EgoState(
            time_s, self.x_m, heave, pitch, measurement.speed_m_s, self._roll.roll_rad, path_curvature
        )
        self._times.append(state.time_s)
        self._states.append(state)
        if len(self._times) > 2 and self._times[0] < state.time_s - 2 * self.settings.history_s:
            keep = bisect_right(self._times, state.time_s - self.settings.history_s)
            del self._times[:keep], self._states[:keep]
        return state

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
        if time_s >= newest.time_s:
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
            self._states[k] = replace(old, heave_m=heave, pitch_rad=old.pitch_rad + turn.pitch_rad)

    def _deflection(self, measurement: Measurement) -> np.ndarray:
        """Height of the body over the road less its value at rest, at each wheel.

        Newton for wheels and body above the tyres: k (road - wheel) = m_u a_u + m_s a_s.
        """
        inertial = np.concatenate([measurement.body_acc, measurement.wheel_acc])
        return measurement.rattle_m - self._tyre_compliance @ inertial

    def _at_centre(self, values: np.ndarray) -> float:
        """Interpolate a quantity known over the axles to the centre of gravity."""
        axle_values = self._over_axles(values)
        if len(self.axle_x_m) == 1:
            return float(axle_values[0])
        front, rear = self.axle_x_m
        return float((front * axle_values[1] - rear * axle_values[0]) / (front - rear))

    def _over_axles(self, values: np.ndarray) -> list[float]:
        listed = values.tolist()
        return [sum(listed[wheel] for wheel in wheels) / len(wheels) for wheels in self._wheels_of_axle]
