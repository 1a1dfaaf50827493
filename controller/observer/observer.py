"""State observer: state and road estimate from the car's sensors."""

import numpy as np

from foreride.controller.identification.car_identifier import CarIdentifier
from foreride.controller.interface import Estimate, Timing
from foreride.controller.observer.filter_layout import gyros
from foreride.controller.observer.filter_steps import vehicle_state
from foreride.controller.observer.kinematic_filter import Claim, KinematicFilter
from foreride.controller.observer.observer_steps import balance_forces, follow_road
from foreride.controller.observer.road_plane import LEAST_SPEED_M_S, RoadPlane
from foreride.controller.observer.sensor_monitor import ValidatedReading
from foreride.controller.observer.strut_forces import StrutForces
from foreride.vehicle.corner_inertia import corner_inertia
from foreride.vehicle.equations import body_acceleration, state_size
from foreride.vehicle.load import Car
from foreride.vehicle.plant.sensors import PITCH_RATE, ROLL_RATE, SensorNoise, channel_layout

SPEED_FILTER_S, FORWARD_FILTER_S = 0.2, 0.1
SUBSTITUTE_BODY_SIGMA_M_S2, SUBSTITUTE_WHEEL_SIGMA_M_S2, SUBSTITUTE_RATTLE_SIGMA_M = 1.0, 30.0, 0.03
UNKNOWN_RATE_SIGMA_RAD_S = 10.0
"""Standard deviations of the substitutes for a lost sensor."""
BALANCE_PERIOD_S, BALANCE_SIGMA_M_S2, BALANCE_SHARE = 0.05, 0.05, 0.2
"""Period of the balance of forces, its standard deviation, and its share of the modelled acceleration."""
FIRST_BALANCES, BELIEVED_SIGMAS = 4, 2.5


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
        self._vehicle, self._wheels, self._period_s = vehicle, vehicle.wheels, timing.period_s
        self._filter, self._plane = KinematicFilter(vehicle, noise, timing.period_s), RoadPlane(vehicle)
        kinematic_rows = self._plane.kinematic_rows
        self._body = np.linalg.pinv(kinematic_rows)
        force_distribution = np.linalg.pinv(kinematic_rows.T)
        self._residual_projection = (
            np.eye(vehicle.wheels) - force_distribution @ kinematic_rows.T
            if vehicle.wheels > kinematic_rows.shape[1]
            else None
        )
        self._mass = corner_inertia(vehicle)
        arms = np.array(vehicle.inertial_lever_arm_m)
        self._balance_floor = np.array([1.0, *np.full(len(arms) - 1, 3.0)]) ** 2 * BALANCE_SIGMA_M_S2**2
        self._body_mass = np.array(vehicle.generalised_mass)
        self._body_inertial = self._body_mass[0] * arms / self._body_mass
        self._load_transfer = force_distribution @ (self._body_mass[0] * arms)
        self._tyres = np.array([[c.tyre_n_m, c.tyre_damping_ns_m, c.static_tyre_n] for c in corners])
        self._balance_every = max(round(BALANCE_PERIOD_S / timing.period_s), 1)
        self._no_force = self._no_variance = np.zeros(self._wheels)
        self._identifier = CarIdentifier(vehicle, timing.period_s)
        self._channels = channel_layout(vehicle.wheels)
        self._actuators = [corner.actuator for corner in corners if corner.actuator]
        self._force_limit = np.array([actuator.force_limit_n for actuator in self._actuators])
        lags_s = np.array([actuator.lag_s for actuator in self._actuators])
        self._force_share = -np.expm1(-timing.period_s / lags_s)
        self._states, self._strut_forces = state_size(vehicle), StrutForces(vehicle)
        self.reset()

    def reset(self) -> None:
        """Reset to a car at rest on the mean road."""
        self._count = self._balances = 0
        self._filter.reset()
        self._plane.reset()
        self._identifier.reset()
        self._force = np.zeros(len(self._actuators))
        self._deflection = np.zeros(self._wheels)
        self._road = np.zeros(self._wheels)
        self._speed: float | None = None
        self._recent_speed = self._forward_acc = 0.0

    @property
    def claim(self) -> Claim:
        """The filter's state with its covariance, and how the last reading differed from its prediction."""
        own = self._filter
        parts = own.state, own.covariance, own.innovation, own.innovation_covariance
        return Claim(*(part.copy() for part in parts))

    @property
    def plane(self) -> RoadPlane:
        """The frame of the estimates."""
        return self._plane

    def update(
        self, checked: ValidatedReading, command: np.ndarray, forward_acc: float | None = None
    ) -> Estimate:
        """Process a reading and the command that acted until then; return the present estimate.

        forward_acc: commanded longitudinal acceleration, m/s²; None where it is not known.
        """
        w, measurement = self._wheels, checked.measurement
        previous_speed, speed_m_s = self._speed, self._smooth_speed(float(measurement.speed_m_s), forward_acc)
        faster = self._relative_change(previous_speed, speed_m_s)
        channels, variance = measurement.channels(), self._no_variance
        acceleration = channels[self._channels.acceleration]
        self._count += 1
        if checked.is_incomplete:
            acceleration, variance = self._follow_incomplete(channels, acceleration, checked.lost, speed_m_s)
            self._identifier.follow(command[:w])
            self._update_actuator_force(command[w:])
        else:
            self._update_actuator_force(command[w:])
            self._follow_motion(channels, command[:w], speed_m_s)
            if self._count % self._balance_every == 0:
                self._balance_forces(acceleration, speed_m_s)
        road, rate, contact, x = self._follow_road(acceleration, variance, speed_m_s, faster)
        estimate = Estimate.__new__(Estimate)
        estimate.__dict__.update(  # as `__init__`, which takes four times as long
            time_s=float(measurement.time_s),
            x=x,
            road_height=road,
            road_velocity=rate,
            speed_m_s=speed_m_s,
            contact=contact,
            faults=checked.faults,
            forward_acc=forward_acc or 0.0,
            identified=self._identifier.result,
        )
        return estimate

    def _follow_motion(self, channels: np.ndarray, command: np.ndarray, speed_m_s: float) -> None:
        """Filter a reading, and compare the body's acceleration by its struts with that of the known ones."""
        inertial = self._body_inertial, self._forward_acc
        signals = self._filter.follow(channels, self._plane.motion, speed_m_s, self._body, *inertial)
        if self._actuators:
            mass = self._identifier.result.mass * self._body_mass
            signals[: len(mass)] -= self._plane.kinematic_rows.T @ self._force / mass
        self._identifier.update(signals, command)

    def _follow_incomplete(
        self, channels: np.ndarray, acceleration: np.ndarray, lost: tuple[bool, ...], speed_m_s: float
    ) -> tuple[np.ndarray, np.ndarray]:
        """Filter a reading of which some is lost; return accelerations and variance (w,) of deflections."""
        own, plane, model = self._filter, self._plane, self._filter.model
        reading, reading_variance = own.readings(channels, plane.motion), own.reading_variance(speed_m_s)
        acceleration, acceleration_variance = self._without_lost_accelerations(acceleration, lost)
        reading, reading_variance = self._without_lost_readings(reading, reading_variance, lost)
        surplus = acceleration_variance - model.acceleration_variance
        own.predict(acceleration, acceleration_variance)
        plane.adjust(own.correct(reading, reading_variance), speed_m_s)
        return acceleration, (self._mass / self._tyres[:, :1]) ** 2 @ surplus

    def _without_lost_accelerations(
        self, acceleration: np.ndarray, lost: tuple[bool, ...]
    ) -> tuple[np.ndarray, np.ndarray]:
        """Accelerations with substitutes for lost ones, and their variances."""
        mask = np.array(lost)[self._channels.acceleration]
        sigma = np.repeat([SUBSTITUTE_BODY_SIGMA_M_S2, SUBSTITUTE_WHEEL_SIGMA_M_S2], self._wheels)
        variance = np.where(mask, sigma**2, self._filter.model.acceleration_variance)
        return np.where(mask, self._substitute_accelerations(), acceleration), variance

    def _without_lost_readings(
        self, reading: np.ndarray, variance: np.ndarray, lost: tuple[bool, ...]
    ) -> tuple[np.ndarray, np.ndarray]:
        """Readings with zero for lost travels, as suspensions stay between stops, and their variances."""
        w, g, mask = self._wheels, gyros(self._wheels), np.array(lost)
        read = np.zeros(len(reading), dtype=bool)
        read[:w] = mask[self._channels.rattle]
        reading = np.where(read, 0.0, reading)
        variance = np.where(read, SUBSTITUTE_RATTLE_SIGMA_M**2, variance)
        variance[w : w + g][mask[[PITCH_RATE, ROLL_RATE][:g]]] = UNKNOWN_RATE_SIGMA_RAD_S**2
        return reading, variance

    def _balance_forces(self, acceleration: np.ndarray, speed_m_s: float) -> None:
        """Compare the body's measured acceleration with that which the forces of its struts give it.

        The first comparisons tell sensors that are as specified from others, of which less is believed.
        """
        own, identified = self._filter, self._identifier.result
        balance_forces(
            own.state,
            own.covariance,
            own.model.balance,
            acceleration,
            self._body,
            self._plane.kinematic_rows,
            self._struts(),
            identified.mass * self._body_mass,
            self._body_inertial * self._forward_acc,
            self._balance_floor,
            BALANCE_SHARE,
            self._plane.motion,
            speed_m_s,
        )
        self._balances += 1
        if self._balances == FIRST_BALANCES and np.abs(own.unspecified()).max() < BELIEVED_SIGMAS:
            self._plane.adjust(own.confirm(), speed_m_s)

    def _struts(self) -> np.ndarray:
        """Modelled forces of spring, damper, stop and actuator on the body at each wheel, N."""
        return self._strut_forces(self._vehicle_state(), self._identifier.result.damper)

    def _update_actuator_force(self, requested: np.ndarray) -> None:
        """Follow the requested forces (wheels,), which may be absent for none."""
        if not self._actuators:
            return
        asked = np.clip(requested if len(requested) else 0.0, -self._force_limit, self._force_limit)
        self._force = self._force + self._force_share * (asked - self._force)

    def _substitute_accelerations(self) -> np.ndarray:
        """Substitute accelerometer readings (2w,): body driven by the modelled struts, wheels at rest."""
        level = np.zeros(self._wheels)
        body = body_acceleration(self._vehicle, self._vehicle_state(), level, level)
        return self._filter.state[self._filter.rows.offset] + np.concatenate([body, level])

    def _follow_road(
        self, acceleration: np.ndarray, variance: np.ndarray, speed_m_s: float, faster: float
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Estimate the road from the tyre force, and let the frame follow its plane.

        Returns the road's height, its rate, contact and the state of the vehicle. acceleration: (2w,) as
        measured. variance: (w,) of the tyre deflections due to lost sensors, to which that of sound ones is
        added. Without contact the height is an upper bound. With more wheels than rigid-body motions, the
        part of the forces that cancels in the body is taken from the strut model. The frame is inertial
        between updates, as the prediction of the controllers takes it to be.
        """
        by_struts = self._no_force
        if self._residual_projection is not None:
            by_struts = self._residual_projection @ self._struts()
        own, model, wheels = self._filter, self._filter.model, self._wheels
        before, self._road = self._road, np.empty(wheels)
        found = self._road, np.empty(wheels), np.empty(wheels, dtype=bool), np.empty(self._states)
        follow_road(
            own.state,
            own.covariance,
            model.frame,
            model.frame_drive,
            model.faster,
            *self._plane.parts,
            self._deflection,
            acceleration,
            variance,
            self._identifier.result.mass,
            self._mass,
            self._load_transfer,
            self._forward_acc,
            by_struts,
            self._tyres,
            self._period_s,
            speed_m_s,
            faster,
            self._body,
            self._inputs(),
            before,
            *found,
        )
        return found

    def _inputs(self) -> np.ndarray:
        """Settings of the dampers, then forces of the actuators."""
        settings = self._identifier.settings
        return np.concatenate([settings, self._force]) if self._actuators else settings

    def _vehicle_state(self) -> np.ndarray:
        x = np.empty(self._states)
        vehicle_state(self._filter.state, self._body, self._inputs(), x)
        return x

    @staticmethod
    def _relative_change(previous: float | None, speed_m_s: float) -> float:
        """Relative change of the speed, by which the frame's velocity changes; -1 at standstill."""
        if previous is None or speed_m_s < LEAST_SPEED_M_S:
            return -1.0
        return speed_m_s / max(previous, LEAST_SPEED_M_S) - 1.0

    def _smooth_speed(self, measured: float, forward_acc: float | None) -> float:
        """Low-pass filtered speed; the lag of a faster filter gives the forward acceleration."""
        if self._speed is None:
            self._speed = self._recent_speed = measured
        self._forward_acc = (measured - self._recent_speed) / FORWARD_FILTER_S
        if forward_acc is not None:
            self._forward_acc = forward_acc
            self._speed += forward_acc * self._period_s
        self._recent_speed += min(1.0, self._period_s / FORWARD_FILTER_S) * (measured - self._recent_speed)
        self._speed += min(1.0, self._period_s / SPEED_FILTER_S) * (measured - self._speed)
        return self._speed
