"""Model of the kinematic filter: motion and readings of a car on a moving frame, and their noise.

Errors that do not change within a drive are states, each with the standard deviation that its sensor's data
sheet gives: offsets of accelerometers and gyros, zero errors of the suspension travel. As first-order
Gauss-Markov processes they forget within `SENSOR_DRIFT_S` (P. S. Maybeck, Stochastic models, estimation and
control, vol. 1, 1979, ch. 4).
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from scipy.linalg import null_space

from foreride.controller.observer.filter_layout import filter_layout, gyros
from foreride.controller.observer.road_plane import BANDWIDTH_RAD_S
from foreride.vehicle.equations import rest_per_road_height
from foreride.vehicle.load import Car
from foreride.vehicle.plant.sensors import SensorNoise
from foreride.vehicle.state_layout import state_layout

SENSOR_DRIFT_S = 600.0
"""Correlation time of offsets and zero errors, s."""
LIFETIME_OFFSET_M_S2, LIFETIME_ZERO_M = 0.2, 4e-3
"""Standard deviations over temperature and life: of a body accelerometer's offset, a level sensor's zero."""
WARP_SIGMA_M, WARP_RATE_SIGMA_M_S = 3e-5, 3e-4
"""Standard deviations of the warp of the body's corners and of its rate in the pseudo-measurement."""
CURVE_SIGMA_M_S2, CURVE_TIME_S, CURVE_ARM_M = 0.1, 0.5, 1.5
"""Standard deviation and correlation time of the plane's acceleration, and the lever arm of its rotation."""
START_HEIGHT_SIGMA_M, START_VELOCITY_SIGMA_M_S, START_RATE_SIGMA = 1e-3, 5e-3, 2e-3
"""Standard deviations at the start, with the car at rest on the road's plane."""
_SMALL_M = 1e-3
SIGMA_FLOORS = {"m/s²": 1e-3, "m": 1e-5, "rad/s": 1e-5}
"""Least standard deviations, which keep the filter of ideal sensors regular."""


class FilterModel(NamedTuple):
    """s⁺ = transition·s + drive·a; then the frame follows: s⁺ = frame[follows]·s + frame_drive[follows]·d.

    faster·s is added to it per relative change of the speed, as the frame's velocity is slope times speed.

    s: see `controller.observer.filter_layout`. a: (2w,) accelerations of body corners, then wheels. d: (w,)
    errors of the tyre deflections. y = output·s: suspension travel (w), gyros, acceleration of the plane in
    body coordinates, warp of the body's corners and its rate. balance·s: what the measured acceleration
    of the body exceeds that of the forces by, in body coordinates. process: covariance of s⁺ per period, but
    for that of a. start: initial covariance. acceleration_variance (2w,), reading_variance (y): of sensors in
    order.
    specified_variance (size,): of the offsets and zero errors of sensors that are as specified.
    """

    transition: np.ndarray
    drive: np.ndarray
    frame: tuple[np.ndarray, np.ndarray]
    frame_drive: tuple[np.ndarray, np.ndarray]
    faster: np.ndarray
    output: np.ndarray
    balance: np.ndarray
    process: np.ndarray
    start: np.ndarray
    acceleration_variance: np.ndarray
    reading_variance: np.ndarray
    specified_variance: np.ndarray


@lru_cache(maxsize=64)
def filter_model(vehicle: Car, noise: SensorNoise, period_s: float) -> FilterModel:
    """Model for one reading every `period_s`."""
    transition, drive = _motion(vehicle, period_s)
    frozen, following = (_frame(vehicle, period_s, follows) for follows in (False, True))
    specified = _constant_errors(vehicle, noise)
    constant = _over_life(vehicle, specified)
    kept = np.exp(-period_s / SENSOR_DRIFT_S)
    known = constant > 0.0
    transition[known] *= np.where(known, kept, 1.0)[known][:, None]
    process = np.diag((1.0 - kept**2) * constant**2) + 1e-16 * np.eye(len(constant))
    return FilterModel(
        transition,
        drive,
        (frozen[0], following[0]),
        (np.ascontiguousarray(frozen[1]), np.ascontiguousarray(following[1])),
        _frame_velocity(vehicle) @ np.eye(len(constant))[filter_layout(vehicle).plane_rate],
        _output(vehicle),
        _balance(vehicle),
        process,
        np.diag(_start_sigma(vehicle, constant) ** 2),
        _acceleration_variance(vehicle, noise),
        _reading_variance(vehicle, noise, period_s),
        specified**2,
    )


def _motion(vehicle: Car, period_s: float) -> tuple[np.ndarray, np.ndarray]:
    """Double integrators of the accelerations less their offsets, and their input matrix."""
    rows, w, t = filter_layout(vehicle), vehicle.wheels, period_s
    transition, drive = np.eye(rows.size), np.zeros((rows.size, 2 * w))
    height, velocity = slice(0, 2 * w), slice(2 * w, 4 * w)
    transition[height, velocity] = t * np.eye(2 * w)
    drive[height], drive[velocity] = 0.5 * t**2 * np.eye(2 * w), t * np.eye(2 * w)
    transition[:, rows.offset] -= drive
    return transition, drive


def _frame(vehicle: Car, period_s: float, follows: bool) -> tuple[np.ndarray, np.ndarray]:
    """`RoadPlane.correct` as a map of s and as one of the errors of the tyre deflections.

    A plane that does not follow, over an obstacle, only goes on with its acceleration.
    """
    rows, t, omega = filter_layout(vehicle), period_s, BANDWIDTH_RAD_S
    kinematic_rows = np.array([corner.kinematic_row for corner in vehicle.corners])
    body_of_road = rest_per_road_height(vehicle)[state_layout(vehicle).body]
    innovation = np.zeros((len(body_of_road), rows.size))
    if follows:
        innovation[:, rows.wheel] = body_of_road
        innovation[:, rows.plane_offset] = -body_of_road @ kinematic_rows
    change = 2.0 * omega**2 * t * innovation
    change[:, rows.plane_acceleration] += t * np.eye(len(change))
    step = np.eye(rows.size)
    step[rows.plane_offset] += 2.0 * omega * t * innovation
    step[rows.plane_acceleration] += omega**3 * t * innovation
    step += _frame_velocity(vehicle) @ change
    return step, (step - np.eye(rows.size))[:, rows.wheel]


def _frame_velocity(vehicle: Car) -> np.ndarray:
    """Change of s per change of the frame's velocity, (size, body)."""
    rows = filter_layout(vehicle)
    kinematic_rows = np.array([corner.kinematic_row for corner in vehicle.corners])
    effect = np.zeros((rows.size, kinematic_rows.shape[1]))
    effect[rows.plane_rate] = np.eye(kinematic_rows.shape[1])
    effect[rows.body_velocity] = effect[rows.wheel_velocity] = -kinematic_rows
    return effect


def _output(vehicle: Car) -> np.ndarray:
    rows, w, g = filter_layout(vehicle), vehicle.wheels, gyros(vehicle.wheels)
    kinematic_rows = np.array([corner.kinematic_row for corner in vehicle.corners])
    body, warps = kinematic_rows.shape[1], null_space(kinematic_rows.T).T
    travel, angular, curve, warp, warp_rate = (
        np.zeros((count, rows.size)) for count in (w, g, body, len(warps), len(warps))
    )
    travel[:, rows.body], travel[:, rows.wheel], travel[:, rows.zero_error] = np.eye(w), -np.eye(w), np.eye(w)
    angular[: body - 1, rows.body_velocity] = np.linalg.pinv(kinematic_rows)[1:]
    angular[: body - 1, rows.plane_rate] = np.eye(body)[1:]
    angular[:, rows.gyro_offset] = np.eye(g)
    curve[:, rows.plane_acceleration] = np.eye(body)
    warp[:, rows.body], warp_rate[:, rows.body_velocity] = warps, warps
    return np.vstack([travel, angular, curve, warp, warp_rate])


def _balance(vehicle: Car) -> np.ndarray:
    rows, corners = filter_layout(vehicle), vehicle.corners
    kinematic_rows = np.array([corner.kinematic_row for corner in corners])
    rates = [
        (c.spring_force(-_SMALL_M, np) - c.spring_force(_SMALL_M, np)) / (2.0 * _SMALL_M) for c in corners
    ]
    stiffness = kinematic_rows.T @ np.diag(rates) / np.array(vehicle.generalised_mass)[:, None]
    balance = np.zeros((kinematic_rows.shape[1], rows.size))
    balance[:, rows.offset][:, : vehicle.wheels] = np.linalg.pinv(kinematic_rows)
    balance[:, rows.body], balance[:, rows.wheel] = -stiffness, stiffness
    return balance


def _constant_errors(vehicle: Car, noise: SensorNoise) -> np.ndarray:
    """Standard deviation of each state that is an error of a sensor, zero of the others, (size,)."""
    rows, w = filter_layout(vehicle), vehicle.wheels
    sigma = np.zeros(rows.size)
    sigma[rows.offset] = np.repeat([noise.body_offset_m_s2, noise.wheel_offset_m_s2], w) + 1e-5
    rates = [noise.pitch_rate_offset_rad_s, noise.roll_rate_offset_rad_s]
    sigma[rows.gyro_offset] = np.array(rates[: gyros(w)]) + 1e-6
    sigma[rows.zero_error] = noise.rattle_offset_m + 1e-6
    return sigma


def _over_life(vehicle: Car, specified: np.ndarray) -> np.ndarray:
    """The same for a body accelerometer and a level sensor of which only the type is known."""
    rows, sigma = filter_layout(vehicle), specified.copy()
    body = slice(rows.offset.start, rows.offset.start + vehicle.wheels)
    sigma[body] = np.hypot(sigma[body], LIFETIME_OFFSET_M_S2)
    sigma[rows.zero_error] = np.hypot(sigma[rows.zero_error], LIFETIME_ZERO_M)
    return sigma


def _start_sigma(vehicle: Car, constant: np.ndarray) -> np.ndarray:
    rows, sigma = filter_layout(vehicle), constant.copy()
    sigma[rows.body] = sigma[rows.wheel] = sigma[rows.plane_offset] = START_HEIGHT_SIGMA_M
    sigma[rows.body_velocity] = sigma[rows.wheel_velocity] = START_VELOCITY_SIGMA_M_S
    sigma[rows.plane_rate] = START_RATE_SIGMA
    return sigma


def _acceleration_variance(vehicle: Car, noise: SensorNoise) -> np.ndarray:
    densities = np.repeat([noise.body_density_m_s2, noise.wheel_density_m_s2], vehicle.wheels)
    return densities**2 * noise.bandwidth_hz + SIGMA_FLOORS["m/s²"] ** 2


def _reading_variance(vehicle: Car, noise: SensorNoise, period_s: float) -> np.ndarray:
    w, body = vehicle.wheels, len(vehicle.generalised_mass)
    rates = np.array([noise.pitch_rate_density_rad_s, noise.roll_rate_density_rad_s])[: gyros(w)]
    curve = np.array([1.0, *np.full(body - 1, 1.0 / CURVE_ARM_M)]) * CURVE_SIGMA_M_S2
    variances = [
        np.full(w, noise.rattle_m**2 + SIGMA_FLOORS["m"] ** 2),
        rates**2 * noise.bandwidth_hz + SIGMA_FLOORS["rad/s"] ** 2,
        curve**2 * 2.0 * CURVE_TIME_S / period_s,
        np.repeat([WARP_SIGMA_M, WARP_RATE_SIGMA_M_S], w - body) ** 2,
    ]
    return np.concatenate(variances)
