"""Kinematic Kalman filter: stationary estimator of corner and wheel motion from the car's own sensors.

Measured accelerations drive double integrators, so stiffness, damping and bump stops play no part. Suspension
travel and pitch rate correct them; the pseudo-measurement that the wheels stay near the mean road bounds the
remaining drift.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from scipy.linalg import block_diag, solve_discrete_are

from foreride.vehicle.load import Car
from foreride.vehicle.plant.sensors import PITCH_RATE, SensorNoise, channel_layout

OFFSET_DRIFT_TIME_S = 60.0
"""Time over which a sensor offset drifts by its standard deviation (random walk), s."""
ROAD_DRIFT_DENSITY_M2_S = 1e-3
"""Spectral density of the wheels' distance from the mean road in the drift correction, m²·s."""

SUBSTITUTE_BODY_SIGMA_M_S2, SUBSTITUTE_WHEEL_SIGMA_M_S2, SUBSTITUTE_RATTLE_SIGMA_M = 1.0, 30.0, 0.03
"""Standard deviations of the substitutes for a lost sensor: m/s², m/s², m."""
UNINFORMATIVE_SIGMA = 1e3


class KinematicFilter(NamedTuple):
    """Filter matrices: s⁺ = transition·s + drive·a, then s + gain·(y − output·s).

    s: heights of body corners and wheels (2w), their velocities (2w), accelerometer offsets (2w), gyro
    offset.
    a: (2w,) accelerations of body corners, then wheels. y: suspension travel (w), pitch rate, distance of the
    wheels from the mean road (w), taken as zero.
    """

    transition: np.ndarray
    drive: np.ndarray
    output: np.ndarray
    gain: np.ndarray

    def step(self, s: np.ndarray, acceleration: np.ndarray, reading: np.ndarray) -> np.ndarray:
        """Return the state after one period with this mean acceleration and this reading at its end."""
        predicted = self.transition @ s + self.drive @ acceleration
        return predicted + self.gain @ (reading - self.output @ predicted)


class FilterLayout(NamedTuple):
    """Rows of the filter state s. offset: of all accelerometers. gyro_offset: of the pitch gyro."""

    body: slice
    wheel: slice
    body_velocity: slice
    wheel_velocity: slice
    offset: slice
    gyro_offset: int


def filter_layout(wheels: int) -> FilterLayout:
    """Return the layout of the filter state for this number of wheels."""
    body, wheel, body_velocity, wheel_velocity = (slice(i * wheels, (i + 1) * wheels) for i in range(4))
    offset = slice(4 * wheels, 6 * wheels)
    return FilterLayout(body, wheel, body_velocity, wheel_velocity, offset, gyro_offset=6 * wheels)


@lru_cache(maxsize=64)
def kinematic_filter(
    vehicle: Car, noise: SensorNoise, period_s: float, lost: tuple[bool, ...] | None = None
) -> KinematicFilter:
    """Design the filter for one reading every `period_s`.

    lost: lost channels, in the order of `controller.observer.sensor_monitor.ValidatedReading`. A lost
    acceleration is replaced by a model value, a lost suspension travel by zero, as the suspension stays
    between its stops.
    """
    w, t = vehicle.wheels, period_s
    identity, zeros = np.eye(2 * w), np.zeros((2 * w, 2 * w))
    double_integrator = np.block([[identity, t * identity], [zeros, identity]])
    drive = np.vstack([0.5 * t**2 * identity, t * identity, zeros, np.zeros((1, 2 * w))])
    transition = block_diag(double_integrator, identity, 1.0)
    transition[:, filter_layout(w).offset] -= drive
    output = _output(vehicle)
    process, reading = _covariances(vehicle, noise, drive, t, lost or (False,) * (3 * w + 3))
    p = solve_discrete_are(transition.T, output.T, process, reading)
    gain = p @ output.T @ np.linalg.inv(output @ p @ output.T + reading)
    return KinematicFilter(transition, drive, output, gain)


def _output(vehicle: Car) -> np.ndarray:
    w, rows = vehicle.wheels, filter_layout(vehicle.wheels)
    output = np.zeros((2 * w + 1, 6 * w + 1))
    output[:w, rows.body], output[:w, rows.wheel] = np.eye(w), -np.eye(w)
    kinematic_rows = np.array([corner.kinematic_row for corner in vehicle.corners])
    if kinematic_rows.shape[1] > 1:
        output[w, rows.body_velocity] = np.linalg.pinv(kinematic_rows)[1]
    output[w, rows.gyro_offset] = 1.0
    output[w + 1 :, rows.wheel] = np.eye(w)
    return output


def _covariances(
    vehicle: Car, noise: SensorNoise, drive: np.ndarray, period_s: float, lost: tuple[bool, ...]
) -> tuple[np.ndarray, np.ndarray]:
    """Covariances of the process per period and of one reading, with floors that keep the filter regular."""
    w, lost_mask = vehicle.wheels, np.array(lost)
    channels = channel_layout(w)
    lost_acceleration = lost_mask[channels.acceleration]
    root = np.sqrt(noise.bandwidth_hz)
    acceleration = np.repeat([noise.body_density_m_s2 * root, noise.wheel_density_m_s2 * root], w)
    substitute = np.repeat([SUBSTITUTE_BODY_SIGMA_M_S2, SUBSTITUTE_WHEEL_SIGMA_M_S2], w)
    acceleration[lost_acceleration] = substitute[lost_acceleration]
    offsets = np.repeat([noise.body_offset_m_s2, noise.wheel_offset_m_s2], w)
    offset_drift = np.array([*offsets, noise.pitch_rate_offset_rad_s]) + 1e-5
    drifting = slice(filter_layout(w).offset.start, None)
    process = drive @ np.diag((acceleration + 1e-3) ** 2) @ drive.T
    process[drifting, drifting] += np.diag(offset_drift**2 * period_s / OFFSET_DRIFT_TIME_S)
    process += 1e-16 * np.eye(len(process))
    rate = UNINFORMATIVE_SIGMA if lost[PITCH_RATE] else noise.pitch_rate_density_rad_s * root + 1e-5
    rattle = np.where(lost_mask[channels.rattle], SUBSTITUTE_RATTLE_SIGMA_M, noise.rattle_m + 1e-5)
    road = np.full(w, np.sqrt(ROAD_DRIFT_DENSITY_M2_S / period_s))
    return process, np.diag(np.concatenate([rattle, [rate], road]) ** 2)
