"""Claims of the observer over a drive: its errors beside the covariances that it states for them.

Errors are relative to the frame that the road, known exactly, gives to the same filter of its plane over the
same obstacles (`controller.observer.road_plane`).
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from foreride.controller.interface import Estimate
from foreride.controller.observer.exact_observer import ExactObserver
from foreride.controller.observer.filter_layout import FilterLayout, filter_layout, gyros
from foreride.controller.observer.observer import Observer
from foreride.files.errors import InputError
from foreride.scenarios.cases import Case
from foreride.scenarios.simulation.simulate import assembled
from foreride.vehicle.load import Car, control_model
from foreride.vehicle.plant.sensors import PITCH_RATE, ROLL_RATE, channel_layout
from foreride.vehicle.state_layout import state_layout

EVERY = 10
"""Errors are kept of every so manieth decision; they change slowly beside the period."""


@dataclass(frozen=True, eq=False)
class Claims:
    """Errors (n, states) and covariances (n, states, states); innovations (m, sensors), in their sigmas."""

    car: Car
    errors: np.ndarray
    covariances: np.ndarray
    innovations: np.ndarray


def observer_claims(case: Case) -> Claims:
    """Claims over a drive. Raises InputError for one that has no observer."""
    car = control_model(case.scenario.vehicle.parameters)
    loop, plant, perception = assembled(case)
    observer, exact, rows = loop.observer, ExactObserver(car), filter_layout(car)
    if observer is None:
        raise InputError("observer: must be sensors, got truth")
    errors, covariances, innovations = [], [], []
    offset, sensors = loop.sensors.offset, car.wheels + gyros(car.wheels)
    try:
        for count, _ in enumerate(loop.controlled(lambda ticks: None)):
            truth = exact.update(plant.state, bool(observer.plane.obstacle_m.any()))
            claim = observer.claim
            innovations.append((claim.innovation / np.sqrt(np.diag(claim.innovation_covariance)))[:sensors])
            if count % EVERY == 0:
                errors.append(_estimated(observer, rows) - _true(car, truth, exact, offset))
                covariances.append(claim.covariance)
    finally:
        perception.close()
    if not errors:
        raise InputError(f"{case.controller} has no observer: its dampers are fixed")
    return Claims(car, np.array(errors), np.array(covariances), np.array(innovations))


def _estimated(observer: Observer, rows: FilterLayout) -> np.ndarray:
    state, plane = observer.claim.state.copy(), observer.plane
    state[rows.plane] = np.concatenate([plane.offset, plane.acceleration, plane.rate])
    return state


def _true(car: Car, truth: Estimate, exact: ExactObserver, offset: np.ndarray) -> np.ndarray:
    """The filter's state as it should be."""
    layout, channels, plane = state_layout(car), channel_layout(car.wheels), exact.plane
    body, body_velocity = (
        plane.kinematic_rows @ truth.x[part] for part in (layout.body, layout.body_velocity)
    )
    motion = [body, truth.x[layout.wheel], body_velocity, truth.x[layout.wheel_velocity]]
    rates = offset[[PITCH_RATE, ROLL_RATE][: gyros(car.wheels)]]
    frame = [plane.offset, plane.acceleration, plane.rate]
    return np.concatenate([*motion, offset[channels.acceleration], rates, offset[channels.rattle], *frame])


def state_groups(car: Car) -> Mapping[str, np.ndarray]:
    """Map (k, states) from the filter's state to each group of states that belong together."""
    rows = filter_layout(car)
    unit, body = np.eye(rows.size), np.linalg.pinv([corner.kinematic_row for corner in car.corners])
    velocity = body @ unit[rows.body_velocity]
    groups = {
        "heave velocity, m/s": velocity[:1],
        "pitch rate, roll rate, rad/s": velocity[1:],
        "wheel velocities, m/s": unit[rows.wheel_velocity],
        "suspension travel, m": unit[rows.body] - unit[rows.wheel],
        "rate of travel, m/s": unit[rows.body_velocity] - unit[rows.wheel_velocity],
        "wheel heights over the plane, m": unit[rows.wheel],
        "body accelerometer offsets, m/s²": body[:1] @ unit[rows.offset][: car.wheels],
        "wheel accelerometer offsets, m/s²": unit[rows.offset][car.wheels :],
        "gyro offsets, rad/s": unit[rows.gyro_offset],
        "zero errors of travel, m": unit[rows.zero_error],
    }
    return {name: rows for name, rows in groups.items() if len(rows)}
