"""Steps of the observer's Kalman filter in compiled loops, which skip the zeros of sparse matrices.

Rows of its state are as in `controller.observer.filter_layout`.
"""

from typing import Any

import numpy as np

from foreride.files.jit import copy_vector, njit

DEFLECTION_SIGMA_M, AIR_SIGMA_M = 3e-4, 0.02
"""Standard deviation of the tyre deflection as the accelerations give it: on the ground and off it."""
LIFT_OFF_LOAD_RATIO = 0.02
"""Fraction of the static wheel load below which a wheel counts as lifted."""


@njit
def propagated(covariance: Any, matrix: Any, inputs: Any, variance: Any) -> Any:
    """M P Mᵀ + B diag(v) Bᵀ of the transition M (n, n) and the inputs B (n, m), symmetric to the last bit."""
    n = len(covariance)
    half, out = np.zeros((n, n)), np.zeros((n, n))
    for i in range(n):
        for k in range(n):
            factor = matrix[i, k]
            if factor != 0.0:
                for j in range(n):
                    half[j, i] += factor * covariance[k, j]
    for i in range(n):
        for k in range(n):
            factor = matrix[i, k]
            if factor != 0.0:
                for j in range(i + 1):
                    out[i, j] += factor * half[k, j]
        for m in range(len(variance)):
            if inputs[i, m] != 0.0:
                factor = inputs[i, m] * variance[m]
                for j in range(i + 1):
                    out[i, j] += factor * inputs[j, m]
        for j in range(i):
            out[j, i] = out[i, j]
    return out


@njit
def product(matrix: Any, vector: Any) -> Any:
    """Matrix times vector."""
    out = np.zeros(len(matrix))
    for i in range(len(matrix)):
        for j in range(len(vector)):
            out[i] += matrix[i, j] * vector[j]
    return out


@njit
def taken_in(state: Any, covariance: Any, output: Any, innovation: Any, variance: Any) -> Any:
    """State and covariance after readings of independent errors, one after the other.

    output: (m, n). innovation: (m,) readings less those expected of `state`. variance: (m,) of their errors.
    """
    n = len(state)
    change, covariance = np.zeros(n), covariance.copy()
    cross = np.empty(n)
    for m in range(len(innovation)):
        row, rest = output[m], innovation[m]
        cross[:] = 0.0
        for k in range(n):
            if row[k] != 0.0:
                rest -= row[k] * change[k]
                for j in range(n):
                    cross[j] += row[k] * covariance[k, j]
        expected = variance[m]
        for k in range(n):
            expected += row[k] * cross[k]
        for i in range(n):
            change[i] += cross[i] * (rest / expected)
        sigma = np.sqrt(expected)
        for i in range(n):
            cross[i] /= sigma
        for i in range(n):
            for j in range(n):
                covariance[i, j] -= cross[i] * cross[j]
    for i in range(n):
        change[i] += state[i]
    return change, covariance


@njit
def expected_covariance(covariance: Any, output: Any, variance: Any) -> Any:
    """Covariance H P Hᵀ + diag(v) of the innovation of readings taken at once."""
    count, n = output.shape
    out, cross = np.empty((count, count)), np.empty(n)
    for i in range(count):
        cross[:] = 0.0
        for k in range(n):
            if output[i, k] != 0.0:
                for j in range(n):
                    cross[j] += output[i, k] * covariance[k, j]
        for j in range(i + 1):
            total = variance[i] if i == j else 0.0
            for k in range(n):
                total += output[j, k] * cross[k]
            out[i, j] = out[j, i] = total
    return out


@njit
def predicted(
    state: Any,
    covariance: Any,
    samples: Any,
    variance: Any,
    aliasing: Any,
    transition: Any,
    drive: Any,
    process: Any,
) -> Any:
    """State and covariance one period on.

    samples: (3, m) accelerations of the period's end, of its beginning and one period before. aliasing:
    standard deviation of the period's mean acceleration per second difference of them.
    """
    count, n = len(variance), len(state)
    mean, spread = np.empty(count), np.empty(count)
    for i in range(count):
        now, previous, before = samples[0, i], samples[1, i], samples[2, i]
        mean[i] = (5.0 * now + 8.0 * previous - before) / 12.0
        spread[i] = variance[i] + (aliasing * (now - 2.0 * previous + before)) ** 2
    moved, driven = product(transition, state), product(drive, mean)
    after = propagated(covariance, transition, drive, spread)
    for i in range(n):
        moved[i] += driven[i]
        for j in range(n):
            after[i, j] += process[i, j]
    return moved, after


@njit
def corrected(state: Any, covariance: Any, output: Any, reading: Any, variance: Any) -> Any:
    """State and covariance after a reading, its innovation and that one's covariance."""
    innovation = product(output, state)
    for i in range(len(reading)):
        innovation[i] = reading[i] - innovation[i]
    expected = expected_covariance(covariance, output, variance)
    state, covariance = taken_in(state, covariance, output, innovation, variance)
    return state, covariance, innovation, expected


@njit
def readings(channels: Any, wheels: int, gyros: int, motion: Any, count: int) -> Any:
    """Readings (count,) of the filter from those of the sensors and the plane's motion.

    Travel, rates relative to the plane, and the plane's acceleration, which stands for none, then zeros.
    motion: rows of `RoadPlane`.
    """
    _, _, rate, _, acceleration = motion
    reading = np.zeros(count)
    for i in range(wheels):
        reading[i] = channels[2 * wheels + i]
    for i in range(gyros):  # pitch rate and roll rate, with the speed between them
        reading[wheels + i] = channels[3 * wheels + 2 * i]
        if 1 + i < len(rate):
            reading[wheels + i] -= rate[1 + i]
    for i in range(len(acceleration)):
        reading[wheels + gyros + i] = -acceleration[i]
    return reading


@njit
def reframed(
    state: Any,
    covariance: Any,
    change: Any,
    frame: Any,
    by_speed: Any,
    faster: float,
    drive: Any,
    variance: Any,
) -> Any:
    """Covariance after the velocity of the frame has changed by `change` (wheels,), and `state` in place.

    frame, by_speed: map of s, and what is added to it by the relative change of the speed, `faster`.
    """
    wheels, moved = len(change), frame.copy()
    for i in range(len(state)):
        for j in range(len(state)):
            moved[i, j] += faster * by_speed[i, j]
    for i in range(wheels):
        state[2 * wheels + i] -= change[i]
        state[3 * wheels + i] -= change[i]
    return propagated(covariance, moved, drive, variance)


@njit
def strut_motion(
    state: Any, acceleration: Any, body_of_corners: Any, inertial: Any, forward_acc: float, motion: Any
) -> None:
    """Write the acceleration of the body (body,) by its struts, then travel and rate of the suspensions.

    acceleration: (2w,) as measured. inertial: (body,) acceleration against that by the longitudinal inertial
    force, per forward acceleration.
    """
    body, wheels = body_of_corners.shape
    for i in range(body):
        measured = 0.0
        for w in range(wheels):
            measured += body_of_corners[i, w] * (acceleration[w] - state[4 * wheels + w])
        motion[i] = measured + inertial[i] * forward_acc
    for w in range(wheels):
        motion[body + w] = state[w] - state[wheels + w]
        motion[body + wheels + w] = state[2 * wheels + w] - state[3 * wheels + w]


@njit
def vehicle_state(state: Any, body_of_corners: Any, inputs: Any, x: Any) -> None:
    """Write the state of `vehicle.equations` without internal states.

    inputs: settings of the dampers, then forces of the actuators.
    """
    body, wheels = body_of_corners.shape
    moving = 2 * (body + wheels)
    for i in range(body):
        height, rate = 0.0, 0.0
        for w in range(wheels):
            height += body_of_corners[i, w] * state[w]
            rate += body_of_corners[i, w] * state[2 * wheels + w]
        x[2 * i], x[2 * i + 1] = height, rate
    for w in range(wheels):
        x[2 * (body + w)], x[2 * (body + w) + 1] = state[wheels + w], state[3 * wheels + w]
    copy_vector(inputs, x[moving:])


@njit
def road_from_tyre(
    state: Any,
    previous_m: Any,
    deflection: Any,
    acceleration: Any,
    variance: Any,
    mass: float,
    masses: Any,
    transfer: Any,
    forward_acc: float,
    by_struts: Any,
    tyres: Any,
    period_s: float,
    road: Any,
    contact: Any,
    rate: Any,
) -> Any:
    """Write the road's height (wheels,), contact and rate of the height; return the deflections' variance.

    previous_m: (wheels,) height one period before. deflection: (wheels,) of the tyres, replaced in place.
    acceleration: (2w,) as measured. variance: (wheels,) of the deflections, due to lost sensors. mass: of the
    body over the known one. masses: (wheels, 2w), see `vehicle.corner_inertia`. transfer: (wheels,) forces by
    the longitudinal acceleration, `forward_acc`. by_struts: (wheels,) those that cancel in the body. tyres:
    (wheels, 3) stiffness, damping and static force.
    """
    wheels = len(previous_m)
    spread = np.empty(wheels)
    for i in range(wheels):
        body, wheel = 0.0, 0.0
        for k in range(wheels):
            body += masses[i, k] * (acceleration[k] - state[4 * wheels + k])
            wheel += masses[i, wheels + k] * (acceleration[wheels + k] - state[5 * wheels + k])
        force = mass * (body + transfer[i] * forward_acc) + wheel + by_struts[i]
        stiffness, damping, static = tyres[i]
        deflection[i] = (force + damping / period_s * deflection[i]) / (stiffness + damping / period_s)
        height = state[wheels + i] + deflection[i]
        contact[i] = force > -(1.0 - LIFT_OFF_LOAD_RATIO) * static
        road[i] = height if contact[i] else min(height, previous_m[i])
        rate[i] = (road[i] - previous_m[i]) / period_s
        spread[i] = variance[i] + (DEFLECTION_SIGMA_M if contact[i] else AIR_SIGMA_M) ** 2
    return spread
