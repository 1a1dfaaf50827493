"""Kinematic Kalman filter: stationary estimator of corner and wheel motion from the car's own sensors.

Measured accelerations drive double integrators, so stiffness, damping and bump stops play no part. Suspension
travel, pitch rate and roll rate correct them. Two pseudo-measurements bound the remaining drift: the wheels
stay near the mean road, and the corners of a rigid body that outnumber its motions stay in one plane, without
warp (an equality constraint as a nearly perfect measurement: D. Simon, Kalman filtering with state equality
constraints, IEEE Trans. Aerosp. Electron. Syst. 38(1), 2002).
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from scipy.linalg import block_diag, null_space, solve_discrete_are

from foreride.vehicle.load import Car
from foreride.vehicle.plant.sensors import PITCH_RATE, ROLL_RATE, SensorNoise, channel_layout

OFFSET_DRIFT_TIME_S = 60.0
"""Time over which a sensor offset drifts by its standard deviation (random walk), s."""
ROAD_DRIFT_DENSITY_M2_S = 1e-3
"""Spectral density of the wheels' distance from the mean road in the drift correction, m²·s."""
WARP_SIGMA_M, WARP_RATE_SIGMA_M_S = 3e-5, 3e-4
"""Standard deviations of the warp of the body's corners and of its rate in the pseudo-measurement."""

SUBSTITUTE_BODY_SIGMA_M_S2, SUBSTITUTE_WHEEL_SIGMA_M_S2, SUBSTITUTE_RATTLE_SIGMA_M = 1.0, 30.0, 0.03
"""Standard deviations of the substitutes for a lost sensor: m/s², m/s², m."""
UNINFORMATIVE_SIGMA = 1e3


class KinematicFilter(NamedTuple):
    """Filter matrices: s⁺ = transition·s + drive·a, then s + gain·(y − output·s).

    s: heights of body corners and wheels (2w), their velocities (2w), accelerometer offsets (2w), gyro
    offsets (g): pitch and, in a car that rolls, roll.
    a: (2w,) accelerations of body corners, then wheels. y: suspension travel (w), pitch rate and, in a car
    that rolls, roll rate; then heights of the mean road at the wheels, zero where none are given, and warp,
    taken as zero.
    """

    transition: np.ndarray
    drive: np.ndarray
    output: np.ndarray
    gain: np.ndarray

    def step(self, s: np.ndarray, acceleration: np.ndarray, reading: np.ndarray) -> np.ndarray:
        """Return the state after one period with this mean acceleration and this reading at its end."""
        predicted = self.transition @ s + self.drive @ acceleration
        innovation = -self.output @ predicted
        innovation[: len(reading)] += reading
        return predicted + self.gain @ innovation


class FilterLayout(NamedTuple):
    """Rows of the filter state s. offset: of all accelerometers. gyro_offset: of the gyros."""

    body: slice
    wheel: slice
    body_velocity: slice
    wheel_velocity: slice
    offset: slice
    gyro_offset: slice


def gyros(wheels: int) -> int:
    """Number of gyros that the filter reads: pitch, and roll of a car with more than two wheels."""
    return 1 + (wheels > 2)


def filter_layout(wheels: int) -> FilterLayout:
    """Return the layout of the filter state for this number of wheels."""
    body, wheel, body_velocity, wheel_velocity = (slice(i * wheels, (i + 1) * wheels) for i in range(4))
    offset = slice(4 * wheels, 6 * wheels)
    gyro_offset = slice(6 * wheels, 6 * wheels + gyros(wheels))
    return FilterLayout(body, wheel, body_velocity, wheel_velocity, offset, gyro_offset)


@lru_cache(maxsize=64)
def kinematic_filter(
    vehicle: Car, noise: SensorNoise, period_s: float, lost: tuple[bool, ...] | None = None
) -> KinematicFilter:
    """Design the filter for one reading every `period_s`.

    lost: lost channels, in the order of `controller.observer.sensor_monitor.ValidatedReading`. A lost
    acceleration is replaced by a model value, a lost suspension travel by zero, as the suspension stays
    between its stops.
    """
    w, t, g = vehicle.wheels, period_s, gyros(vehicle.wheels)
    identity, zeros = np.eye(2 * w), np.zeros((2 * w, 2 * w))
    double_integrator = np.block([[identity, t * identity], [zeros, identity]])
    drive = np.vstack([0.5 * t**2 * identity, t * identity, zeros, np.zeros((g, 2 * w))])
    transition = block_diag(double_integrator, identity, np.eye(g))
    transition[:, filter_layout(w).offset] -= drive
    output = _output(vehicle)
    process, reading = _covariances(vehicle, noise, drive, t, lost or (False,) * (3 * w + 3))
    p = solve_discrete_are(transition.T, output.T, process, reading)
    gain = p @ output.T @ np.linalg.inv(output @ p @ output.T + reading)
    return KinematicFilter(transition, drive, output, gain)


def _output(vehicle: Car) -> np.ndarray:
    """Rows: suspension travel, gyros, wheels from the mean road, warp of the body's corners and its rate."""
    w, g, rows = vehicle.wheels, gyros(vehicle.wheels), filter_layout(vehicle.wheels)
    travel, angular, road = (np.zeros((count, rows.gyro_offset.stop)) for count in (w, g, w))
    travel[:, rows.body], travel[:, rows.wheel], road[:, rows.wheel] = np.eye(w), -np.eye(w), np.eye(w)
    kinematic_rows = np.array([corner.kinematic_row for corner in vehicle.corners])
    rotations = np.linalg.pinv(kinematic_rows)[1:]
    angular[: len(rotations), rows.body_velocity] = rotations
    angular[:, rows.gyro_offset] = np.eye(g)
    directions = null_space(kinematic_rows.T).T
    warp, warp_rate = (np.zeros((len(directions), rows.gyro_offset.stop)) for _ in range(2))
    warp[:, rows.body], warp_rate[:, rows.body_velocity] = directions, directions
    return np.vstack([travel, angular, road, warp, warp_rate])


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
    gyro_offsets = [noise.pitch_rate_offset_rad_s, noise.roll_rate_offset_rad_s][: gyros(w)]
    offset_drift = np.array([*offsets, *gyro_offsets]) + 1e-5
    drifting = slice(filter_layout(w).offset.start, None)
    process = drive @ np.diag((acceleration + 1e-3) ** 2) @ drive.T
    process[drifting, drifting] += np.diag(offset_drift**2 * period_s / OFFSET_DRIFT_TIME_S)
    process += 1e-16 * np.eye(len(process))
    densities = (noise.pitch_rate_density_rad_s, PITCH_RATE), (noise.roll_rate_density_rad_s, ROLL_RATE)
    rates = [UNINFORMATIVE_SIGMA if lost[row] else density * root + 1e-5 for density, row in densities]
    rattle = np.where(lost_mask[channels.rattle], SUBSTITUTE_RATTLE_SIGMA_M, noise.rattle_m + 1e-5)
    road = np.full(w, np.sqrt(ROAD_DRIFT_DENSITY_M2_S / period_s))
    warps = w - len(vehicle.generalised_mass)
    warp = np.repeat([WARP_SIGMA_M, WARP_RATE_SIGMA_M_S], warps)
    return process, np.diag(np.concatenate([rattle, rates[: gyros(w)], road, warp]) ** 2)
