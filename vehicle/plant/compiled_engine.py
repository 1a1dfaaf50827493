"""Compiled integration engine for cars with ideal dampers: the equations of motion, a tick at a time.

The method is MuJoCo's: classical Runge-Kutta with the road's force held over the tick. MuJoCo's general rigid
bodies cost some 3 to 9 µs a tick; this engine serves studies of many drives, and MuJoCo remains the reference
(the states agree to rounding). A car gives the same states, bit for bit, alone and among any others.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from foreride.files.jit import njit
from foreride.vehicle.clock import STEP_S
from foreride.vehicle.corner import Corner
from foreride.vehicle.equations import state_size
from foreride.vehicle.load import Car

Array = NDArray[np.float64]
_LARGEST = 1e10
"""Magnitude of a state beyond which the motion has diverged; MuJoCo's, too."""
_COLUMNS = 11
"""Numbers of a corner, see `_corner_row`; its bends follow, place and added stiffness each."""


class CarNumbers(NamedTuple):
    """Numbers of cars of one kind."""

    kinematic_rows: Array  # (cars, wheels, body); of one car without the first axis
    inertia: Array  # (cars, body)
    corners: Array  # (cars, wheels, columns)
    anti_roll: Array  # (cars, axles)


def car_numbers(cars: Sequence[Car]) -> CarNumbers:
    """Numbers of the cars, which must be of one kind."""
    bends = max(len(corner.spring_ramps[1]) for car in cars for corner in car.corners)
    return CarNumbers(
        np.array([[corner.kinematic_row for corner in car.corners] for car in cars], dtype=float),
        np.array([car.generalised_mass for car in cars], dtype=float),
        np.array([[_corner_row(corner, bends) for corner in car.corners] for car in cars]),
        np.array([car.anti_roll_n_m for car in cars], dtype=float).reshape(len(cars), -1),
    )


def _corner_row(corner: Corner, bends: int) -> list[float]:
    """Numbers of a corner; bends that it lacks add nothing."""
    stiffness, own = corner.spring_ramps
    actuator = corner.actuator
    pairs = [number for place, added in own for number in (place, added)]
    return [
        stiffness,
        corner.spring_n_m3,
        corner.stop_gap_m,
        corner.rebound_gap_m,
        corner.stop_n_m2,
        corner.tyre_n_m,
        corner.tyre_damping_ns_m,
        corner.static_tyre_n,
        corner.unsprung_mass_kg,
        corner.damper_lag_s,
        actuator.lag_s if actuator else 1.0,
        *pairs,
        *[0.0] * (2 * (bends - len(own))),
    ]


@njit
def _rates(
    car: CarNumbers, x: Array, target: Array, push: Array, surge: float, strut: Array, out: Array
) -> None:
    """Time derivative of a state; target: settings and forces asked for, push: tyre force of the road."""
    rows, inertia, corner, bars = car
    body, wheels = len(inertia), len(corner)
    damping = 2 * (body + wheels)
    for i in range(wheels):
        at = 2 * (body + i)
        travel, rate = -x[at], -x[at + 1]
        for j in range(body):
            travel += rows[i, j] * x[2 * j]
            rate += rows[i, j] * x[2 * j + 1]
        force = -corner[i, 0] * travel - corner[i, 1] * travel * travel * travel - x[damping + i] * rate
        for column in range(_COLUMNS, corner.shape[1], 2):
            place, added = corner[i, column], corner[i, column + 1]
            force += added * (max(-travel - place, 0.0) - max(-place, 0.0))
        jounce, rebound = max(-travel - corner[i, 2], 0.0), max(travel - corner[i, 3], 0.0)
        force += corner[i, 4] * (jounce * jounce - rebound * rebound)
        out[damping + i] = (target[i] - x[damping + i]) / corner[i, 9]
        if len(target) > wheels:
            acting = x[damping + wheels + i]
            force += acting
            out[damping + wheels + i] = (target[wheels + i] - acting) / corner[i, 10]
        strut[0, i], strut[1, i] = force, travel
    for axle in range(len(bars)):
        left, right = 2 * axle, 2 * axle + 1
        twist = bars[axle] * (strut[1, left] - strut[1, right])
        strut[0, left] -= twist
        strut[0, right] += twist
    for j in range(body):
        total = surge if j == 1 else 0.0
        for i in range(wheels):
            total += rows[i, j] * strut[0, i]
        out[2 * j], out[2 * j + 1] = x[2 * j + 1], total / inertia[j]
    for i in range(wheels):
        at = 2 * (body + i)
        tyre = max(corner[i, 7] + push[i] - corner[i, 5] * x[at] - corner[i, 6] * x[at + 1], 0.0)
        out[at], out[at + 1] = x[at + 1], (tyre - corner[i, 7] - strut[0, i]) / corner[i, 8]


@njit
def _tick(
    car: CarNumbers, before: Array, target: Array, push: Array, surge: float, work: Array, after: Array
) -> None:
    """State after a tick; work: (7, states), slopes of the four stages, a state and two rows of struts."""
    states, x, strut = len(before), work[4], work[5:]
    for stage in range(4):
        ahead = 0.0 if stage == 0 else (STEP_S if stage == 3 else 0.5 * STEP_S)
        for n in range(states):
            x[n] = before[n] + ahead * work[stage - 1, n] if stage else before[n]
        _rates(car, x, target, push, surge, strut, work[stage])
    for n in range(states):
        mean = work[0, n] + 2.0 * work[1, n] + 2.0 * work[2, n] + work[3, n]
        after[n] = before[n] + STEP_S / 6.0 * mean


@njit
def advance_cars(
    numbers: CarNumbers, start: Array, target: Array, push: Array, surge: Array, rows: Array
) -> None:
    """Fill rows (cars, ticks, states) with the states after each tick, from start (cars, states).

    target: (cars, ticks or 1, inputs) within their limits. push: (cars, ticks, wheels). surge: (cars, ticks),
    pitching moment of the longitudinal acceleration.
    """
    cars, ticks, states = rows.shape
    work = np.empty((7, states))
    for car in range(cars):
        before = start[car]
        own = CarNumbers(
            numbers.kinematic_rows[car], numbers.inertia[car], numbers.corners[car], numbers.anti_roll[car]
        )
        for tick in range(ticks):
            asked = target[car, 0 if target.shape[1] == 1 else tick]
            _tick(own, before, asked, push[car, tick], surge[car, tick], work, rows[car, tick])
            before = rows[car, tick]


@njit
def _advance_car(
    car: CarNumbers, limits: Array, row: Array, control: Array, target: Array, work: Array, rows: Array
) -> bool:
    """`CompiledEngine.advance` for (ticks, size); returns whether the motion is finite.

    limits: (2, inputs) lowest and highest target.
    """
    wheels, inputs, before = len(car.corners), len(target), row[1:]
    for tick in range(len(rows)):
        given, after = control[tick], rows[tick, 1:]
        for i in range(inputs):
            asked = given[i if i < wheels else wheels + i]
            low, high = limits[0, i], limits[1, i]
            target[i] = low if asked < low else (high if asked > high else asked)
        surge = given[-1] if len(given) > wheels + inputs else 0.0
        _tick(car, before, target, given[wheels : 2 * wheels], surge, work, after)
        rows[tick, 0] = row[0] + STEP_S * (tick + 1)
        before = after
    return bool(np.abs(before).max() <= _LARGEST)  # not of NaN


class CompiledEngine:
    """Engine of the plant, as `vehicle.plant.mujoco_engine.RolloutEngine`; a row is time, then the state."""

    def __init__(self, parameters: Car) -> None:
        self._numbers = CarNumbers(*(part[0] for part in car_numbers([parameters])))
        self._limits = np.concatenate(target_limits([parameters]))
        self.size = 1 + state_size(parameters)
        self.order = np.arange(1, self.size)
        self._target, self._work = np.empty(self._limits.shape[1]), np.empty((7, self.size - 1))

    def advance(self, row: Array, control: Array, rows: Array) -> Array:
        """Fill rows (ticks, size) with the states after each tick under control (ticks, columns), from `row`.

        Returns the last one. For a single tick, rows may be (size,) and control (columns,).
        """
        if rows.ndim == 1:
            control, rows = control[None], rows[None]
        if not _advance_car(self._numbers, self._limits, row, control, self._target, self._work, rows):
            sound = (np.abs(rows[:, 1:]) <= _LARGEST).all(axis=1)  # the clock stops, as MuJoCo's does
            rows[:, 0] = np.minimum(rows[:, 0], row[0] + STEP_S * np.argmin(sound))
        reached: Array = rows[-1]
        return reached


def target_limits(cars: Sequence[Car]) -> tuple[Array, Array]:
    """Lowest and highest damper settings and actuator forces, (cars, inputs) each."""
    low = [[corner.damping_min_ns_m for corner in car.corners] + _forces(car, -1.0) for car in cars]
    high = [[corner.damping_max_ns_m for corner in car.corners] + _forces(car, 1.0) for car in cars]
    return np.array(low), np.array(high)


def _forces(car: Car, sign: float) -> list[float]:
    return [sign * corner.actuator.force_limit_n for corner in car.corners if corner.actuator]
