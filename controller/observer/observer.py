"""State observer: state and road estimate from the car's sensors."""

import numpy as np

from foreride.controller.interface import Estimate, Timing
from foreride.controller.observer.kinematic_filter import filter_layout, gyros, kinematic_filter
from foreride.controller.observer.road_plane import RoadPlane
from foreride.controller.observer.sensor_monitor import ValidatedReading
from foreride.vehicle.corner_inertia import corner_inertia
from foreride.vehicle.equations import body_acceleration, forces, rest_state
from foreride.vehicle.load import Car
from foreride.vehicle.plant.sensors import SensorNoise, channel_layout
from foreride.vehicle.state_layout import state_layout

SPEED_FILTER_S = 0.2
OFFSET_LEARNING_S = 2.0
"""Time constant with which an acceleration of the plane passes into the offsets of the accelerometers.

The two cannot be told apart. A vertical curve so leaves an error of half a millimetre in the tyre deflection.
"""
LIFT_OFF_LOAD_RATIO = 0.02
"""Fraction of the static wheel load below which a wheel counts as lifted."""


class Observer:
    """Estimator of vehicle state and road height from the car's sensors, with the road as unknown input.

    Readings are validated by `controller.observer.sensor_monitor`; lost channels are replaced by model-based
    substitutes. Motion comes from `controller.observer.kinematic_filter`, the damping from the commands and
    the damper lag, the road from the tyre: the tyre force follows from the accelerations of the masses, and
    the deflection from that force.
    Heights and velocities are relative to the road's plane, the same for `x` and `road_height`: see
    `controller.observer.road_plane`.
    """

    def __init__(self, vehicle: Car, noise: SensorNoise, timing: Timing):
        corners = vehicle.corners
        self._wheels, self._period_s, self._noise = vehicle.wheels, timing.period_s, noise
        self._filter = kinematic_filter(vehicle, noise, timing.period_s)
        kinematic_rows = np.array([corner.kinematic_row for corner in corners])
        self._body = np.linalg.pinv(kinematic_rows)
        force_distribution = np.linalg.pinv(kinematic_rows.T)
        self._residual_projection = (
            np.eye(vehicle.wheels) - force_distribution @ kinematic_rows.T
            if vehicle.wheels > kinematic_rows.shape[1]
            else None
        )
        self._vehicle = vehicle
        self._mass = corner_inertia(vehicle)
        self._static = np.array([corner.static_tyre_n for corner in corners])
        self._stiffness = np.array([corner.tyre_n_m for corner in corners])
        self._tyre_damping = np.array([corner.tyre_damping_ns_m for corner in corners])
        lags = np.array([corner.damper_lag_s for corner in corners])
        self._damper_gain = -np.expm1(-timing.period_s / lags)
        self._state, self._rows = state_layout(vehicle), filter_layout(vehicle.wheels)
        self._channels = channel_layout(vehicle.wheels)
        self._passive = rest_state(vehicle)[self._state.damping]
        self._actuators = [corner.actuator for corner in corners if corner.actuator]
        self._plane = RoadPlane(vehicle)
        self.reset()

    def reset(self) -> None:
        """Reset to a car at rest on the mean road."""
        self._motion = np.zeros(len(self._filter.transition))
        self._acceleration: np.ndarray | None = None
        self._damping = self._passive.copy()
        self._force = np.zeros(len(self._actuators))
        self._deflection = np.zeros(self._wheels)
        self._road = np.zeros(self._wheels)
        self._speed: float | None = None
        self._plane.reset()

    def update(self, checked: ValidatedReading, command: np.ndarray) -> Estimate:
        """Process a reading and the command that acted until then; return the present estimate."""
        w, measurement = self._wheels, checked.measurement
        acceleration = np.concatenate([measurement.body_acc, measurement.wheel_acc])
        rattle, kalman_filter = measurement.rattle_m, self._filter
        if any(checked.lost):
            kalman_filter = kinematic_filter(self._vehicle, self._noise, self._period_s, checked.lost)
            lost_mask = np.array(checked.lost)
            acceleration = np.where(
                lost_mask[self._channels.acceleration], self._substitute_accelerations(), acceleration
            )
            rattle = np.where(lost_mask[self._channels.rattle], 0.0, rattle)
        if self._acceleration is None:
            self._acceleration = acceleration
        mean_acceleration = 0.5 * (acceleration + self._acceleration)
        self._acceleration = acceleration
        rotation = np.zeros(gyros(w))
        rotation[: len(self._plane.rate) - 1] = self._plane.rate[1:]
        rates = np.array([measurement.pitch_rate, measurement.roll_rate][: gyros(w)]) - rotation
        reading = np.concatenate([rattle, rates, self._plane.road_m + self._plane.obstacle_m])
        self._motion = kalman_filter.step(self._motion, mean_acceleration, reading)
        self._damping = self._damping + self._damper_gain * (command[:w] - self._damping)
        if self._actuators:
            self._update_actuator_force(command[w:] if len(command) > w else np.zeros(w))
        previous_road = self._road
        road, contact = self._estimate_road_from_tyre(acceleration - self._motion[self._rows.offset])
        self._road = np.where(contact, road, np.minimum(road, previous_road))
        speed_m_s = self._smooth_speed(float(measurement.speed_m_s))
        plane_change = self._follow_plane(speed_m_s)
        return Estimate(
            time_s=float(measurement.time_s),
            x=self._vehicle_state(),
            road_height=self._road,
            road_velocity=(self._road - previous_road) / self._period_s - plane_change,
            speed_m_s=speed_m_s,
            contact=contact,
            faults=checked.faults,
        )

    def _follow_plane(self, speed_m_s: float) -> np.ndarray:
        """Change the frame's velocity to that of the road's plane; return the change (wheels,) at the wheels.

        The frame is inertial between updates, as the prediction of the controllers takes it to be.
        """
        self._plane.advance(self._period_s)
        change = self._plane.kinematic_rows @ self._plane.correct(self._road, speed_m_s)
        self._motion[self._rows.body_velocity] -= change
        self._motion[self._rows.wheel_velocity] -= change
        learnt = self._plane.release_acceleration(min(1.0, self._period_s / OFFSET_LEARNING_S))
        self._motion[self._rows.offset] += np.tile(learnt, 2)
        return change

    def _update_actuator_force(self, requested: np.ndarray) -> None:
        limit = np.array([actuator.force_limit_n for actuator in self._actuators])
        follow = -np.expm1(-self._period_s / np.array([actuator.lag_s for actuator in self._actuators]))
        self._force = self._force + follow * (np.clip(requested, -limit, limit) - self._force)

    def _substitute_accelerations(self) -> np.ndarray:
        """Substitute accelerometer readings (2w,): body driven by the modelled struts, wheels at rest."""
        level = np.zeros(self._wheels)
        body = body_acceleration(self._vehicle, self._vehicle_state(), level, level)
        return self._motion[self._rows.offset] + np.concatenate([body, level])

    def _estimate_road_from_tyre(self, acceleration: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Estimate road height from the tyre force; return it and the contact flag, (wheels,) each.

        Without contact the height is an upper bound. With more wheels than rigid-body motions, the part of
        the forces that cancels in the body is taken from the strut model.
        """
        force = self._mass @ acceleration
        if self._residual_projection is not None:
            level = np.zeros(self._wheels)
            struts = forces(self._vehicle, self._vehicle_state(), level, level)
            force = force + self._residual_projection @ (
                struts.spring + struts.damper + struts.stop + struts.actuator
            )
        rate = self._tyre_damping / self._period_s
        deflection = (force + rate * self._deflection) / (self._stiffness + rate)
        self._deflection = deflection
        road = self._motion[self._rows.wheel] + deflection
        return road, force > -(1.0 - LIFT_OFF_LOAD_RATIO) * self._static

    def _vehicle_state(self) -> np.ndarray:
        x, state, rows = np.empty(self._state.internal_states.stop), self._state, self._rows
        x[state.body] = self._body @ self._motion[rows.body]
        x[state.body_velocity] = self._body @ self._motion[rows.body_velocity]
        x[state.wheel], x[state.wheel_velocity] = self._motion[rows.wheel], self._motion[rows.wheel_velocity]
        x[state.damping], x[state.force] = self._damping, self._force
        return x

    def _smooth_speed(self, measured: float) -> float:
        speed = measured if self._speed is None else self._speed
        self._speed = speed + min(1.0, self._period_s / SPEED_FILTER_S) * (measured - speed)
        return self._speed
