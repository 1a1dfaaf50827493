"""Compiled steps of the observer: what it does in each period, in few calls rather than one for each part."""

from typing import Any

import numpy as np

from foreride.controller.observer.filter_steps import (
    corrected,
    predicted,
    product,
    readings,
    reframed,
    road_from_tyre,
    strut_motion,
    taken_in,
    vehicle_state,
)
from foreride.controller.observer.road_plane import adjust_plane, followed_plane
from foreride.files.jit import copy_matrix, copy_vector, njit

_UNKNOWN = -1
"""Whether the road is that of an obstacle: for `RoadPlane` to decide."""


@njit
def follow_motion(
    state: Any,
    covariance: Any,
    innovation: Any,
    innovation_covariance: Any,
    samples: Any,
    begun: bool,
    channels: Any,
    gyros: int,
    aliasing: float,
    transition: Any,
    drive: Any,
    process: Any,
    output: Any,
    acceleration_variance: Any,
    reading_variance: Any,
    plane: Any,
    speed_m_s: float,
    body_of_corners: Any,
    inertial: Any,
    forward_acc: float,
    motion: Any,
) -> None:
    """Take in a complete reading, its accelerations first; the last states are corrections to the plane.

    As `KinematicFilter.predict`, `readings`, `correct`, `RoadPlane.adjust` and `strut_motion`. The first five
    arguments are the filter's and change in place, as the motion of the plane (5, body) does. begun: there
    are samples.
    """
    count, wheels = samples.shape[1], samples.shape[1] // 2
    reading = readings(channels, wheels, gyros, plane, len(output))
    for i in range(count):
        samples[2, i] = samples[1, i] if begun else channels[i]
        samples[1, i] = samples[0, i] if begun else channels[i]
        samples[0, i] = channels[i]
    now, spread = state, covariance
    if begun:
        before = state, covariance
        now, spread = predicted(*before, samples, acceleration_variance, aliasing, transition, drive, process)
    now, spread, found, expected = corrected(now, spread, output, reading, reading_variance)
    copy_vector(now, state)
    copy_matrix(spread, covariance)
    copy_vector(found, innovation)
    copy_matrix(expected, innovation_covariance)
    _correct_plane(plane, state, speed_m_s)
    strut_motion(state, channels, body_of_corners, inertial, forward_acc, motion)


@njit
def _correct_plane(plane: Any, state: Any, speed_m_s: float) -> None:
    """Hand the corrections to the plane, which are the last states, over to it."""
    start = len(state) - 3 * plane.shape[1]
    adjust_plane(plane, state[start:], speed_m_s)
    state[start:] = 0.0


@njit
def balance_forces(
    state: Any,
    covariance: Any,
    balance: Any,
    acceleration: Any,
    body_of_corners: Any,
    kinematic_rows: Any,
    struts: Any,
    inertia: Any,
    by_inertia: Any,
    floor: Any,
    share: float,
    plane: Any,
    speed_m_s: float,
) -> None:
    """Take in the body's acceleration beyond that of its modelled forces; changes as in `follow_motion`.

    balance: see `FilterModel`. struts: (wheels,) forces. inertia: (body,) masses and inertias. by_inertia:
    (body,) acceleration by the longitudinal inertial force. floor, share: variance (body,) and relative
    standard deviation of the modelled acceleration.
    """
    body, wheels = body_of_corners.shape
    excess, variance = np.empty(body), np.empty(body)
    for i in range(body):
        measured, force = 0.0, 0.0
        for w in range(wheels):
            measured += body_of_corners[i, w] * (acceleration[w] - state[4 * wheels + w])
            force += kinematic_rows[w, i] * struts[w]
        modelled = force / inertia[i] - by_inertia[i]
        excess[i], variance[i] = measured - modelled, floor[i] + (share * modelled) ** 2
    after = taken_in(state, covariance, balance, excess, variance)
    copy_vector(after[0], state)
    copy_matrix(after[1], covariance)
    _correct_plane(plane, state, speed_m_s)


@njit
def follow_road(
    state: Any,
    covariance: Any,
    frames: Any,
    frame_drives: Any,
    by_speed: Any,
    plane: Any,
    plane_wheels: Any,
    memory: Any,
    kinematic_rows: Any,
    body_of_road: Any,
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
    speed_m_s: float,
    faster: float,
    body_of_corners: Any,
    inputs: Any,
    previous_m: Any,
    road: Any,
    rate: Any,
    contact: Any,
    x: Any,
) -> None:
    """Write the road's height, its rate of change, contact (wheels,) and the state of the vehicle.

    As `road_from_tyre`, then `RoadPlane.advance` and `correct`, `KinematicFilter.move_frame` and
    `vehicle_state`; the filter's state and covariance, those of the plane and deflection change in place.
    faster: relative change of the speed. inputs: settings of the dampers, then forces of the actuators.
    """
    tyre = acceleration, variance, mass, masses, transfer, forward_acc, by_struts, tyres, period_s
    spread = road_from_tyre(state, previous_m, deflection, *tyre, road, contact, rate)
    memory[0] = period_s
    for i in range(plane.shape[1]):
        plane[0, i] += period_s * plane[2, i]
    maps = kinematic_rows, body_of_road
    change = product(
        kinematic_rows,
        followed_plane(plane, plane_wheels, memory, *maps, road, speed_m_s, _UNKNOWN),
    )
    follows = int(not np.any(plane_wheels[0]))
    frame = frames[follows], by_speed, faster, frame_drives[follows]
    copy_matrix(reframed(state, covariance, change, *frame, spread), covariance)
    for w in range(len(rate)):
        rate[w] -= change[w]
    vehicle_state(state, body_of_corners, inputs, x)
