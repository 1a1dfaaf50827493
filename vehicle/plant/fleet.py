"""Fleet simulation for parameter studies: many cars with parameters of their own at one speed on one road.

The states of every car are those of `vehicle.plant.plant.Plant` with the same engine and commands, bit for
bit, for any number of cars and threads.
"""

from collections.abc import Callable, Sequence

import mujoco
import numpy as np
from mujoco.batch import Batch
from numpy.typing import ArrayLike, NDArray

from foreride.files.errors import InputError
from foreride.vehicle.clock import RATE_HZ
from foreride.vehicle.dampers.damper import IdealDamper
from foreride.vehicle.equations import input_size, state_size
from foreride.vehicle.load import Car
from foreride.vehicle.plant.compiled_engine import advance_cars, car_numbers, target_limits
from foreride.vehicle.plant.engine_names import EngineName
from foreride.vehicle.plant.mujoco_engine import RolloutEngine, build_model
from foreride.vehicle.plant.plant import standstill_state
from foreride.vehicle.speed_profile import ConstantSpeed
from foreride.vehicle.state import (
    EffectiveProfile,
    RoadHeights,
    VehicleState,
    observe,
    road_forces,
    road_heights,
    road_under,
)

Array = NDArray[np.float64]
Law = Callable[[Array], Array]
"""Commands (cars, inputs) for the states (cars, states) in the order of `vehicle.equations`."""
_FULL_STATE = mujoco.mjtState.mjSTATE_FULLPHYSICS


class Fleet:
    """Cars of one kind (all quarter, all half or all full cars) with ideal dampers, simulated together.

    threads: of MuJoCo, 0 uses all processors; the compiled engine uses one, for one fleet per process. Raises
    InputError for mixed kinds and for other dampers.
    """

    def __init__(self, cars: Sequence[Car], threads: int = 0, engine: EngineName = "mujoco") -> None:
        shapes = {(car.kind, input_size(car)) for car in cars}
        if len(shapes) != 1:
            raise InputError(f"cars must be of one kind and at least one, got {len(shapes)} kinds")
        if not all(isinstance(corner.damper, IdealDamper) for car in cars for corner in car.corners):
            raise InputError("cars must have ideal dampers to be stepped together")
        self.cars = tuple(cars)
        self._together = _CompiledCars(cars) if engine == "compiled" else _MujocoCars(cars, threads)

    def drive(
        self,
        profiles: Sequence[EffectiveProfile],
        x_m: float,
        speed_m_s: float,
        command: ArrayLike | Law,
        ticks: int,
        period: int = 5,
    ) -> Array:
        """Return the states (cars, ticks + 1, states) in the order of `vehicle.equations`, standstill first.

        profiles: one for each wheel of a car. command: (cars, inputs), held over the drive, or a law that is
        asked every `period` ticks and acts at once.
        """
        shape = (len(self.cars), input_size(self.cars[0]))
        states = np.empty((shape[0], ticks + 1, state_size(self.cars[0])))
        for car, own in zip(self.cars, states, strict=True):
            own[0] = standstill_state(car, road_under(car, profiles, x_m, 0.0)[0])
        push = self._road_force(profiles, x_m, speed_m_s, ticks)
        hold = period if callable(command) else max(ticks, 1)
        for first in range(0, ticks, hold):
            last = min(first + hold, ticks)
            asked = np.asarray(command(states[:, first]) if callable(command) else command, float)
            if asked.shape != shape:
                raise InputError(f"command must have shape {shape}, got {asked.shape}")
            states[:, first + 1 : last + 1] = self._together.advance(
                states[:, first], asked, push[:, first:last]
            )
        return states

    def observe(
        self,
        car: int,
        states: Array,
        profiles: Sequence[EffectiveProfile],
        x_m: float,
        speed_m_s: float,
        command: ArrayLike,
    ) -> VehicleState:
        """Return all signals of one car, computed from the states that `drive` returned.

        command: (cars, inputs), held, or (cars, ticks + 1, inputs).
        """
        time = np.arange(states.shape[1]) / RATE_HZ
        travel = ConstantSpeed(speed_m_s).ahead(x_m, 0, len(time) - 1).edges_m
        own = np.atleast_2d(np.asarray(command, float)[car])
        commands = np.broadcast_to(own, (len(time), own.shape[1])).T
        road = road_under(self.cars[car], profiles, travel, speed_m_s)
        return observe(
            self.cars[car], time, travel, np.full(len(time), speed_m_s), states[car].T, commands, road
        )

    def _road_force(
        self, profiles: Sequence[EffectiveProfile], x_m: float, speed_m_s: float, ticks: int
    ) -> Array:
        """Tyre forces of the road, (cars, ticks, wheels); cars of the same axles share its heights."""
        stretch = ConstantSpeed(speed_m_s).ahead(x_m, 0, ticks)
        heights: dict[tuple[float, ...], RoadHeights] = {}
        push = np.empty((len(self.cars), ticks, self.cars[0].wheels))
        for car, own in zip(self.cars, push, strict=True):
            axles = tuple(car.axle_x_m)
            if axles not in heights:
                heights[axles] = road_heights(car, profiles, stretch)
            own.T[:] = road_forces(car, heights[axles])
        return push


class _MujocoCars:
    """Cars stepped by MuJoCo in threads."""

    def __init__(self, cars: Sequence[Car], threads: int) -> None:
        self._models = [build_model(car) for car in cars]
        self._batch = Batch(self._models[0], len(cars), nthread=threads, persistent=True)
        self._batch.set_models(self._models)
        self._order, self._wheels = RolloutEngine(cars[0]).order, cars[0].wheels
        self._size = mujoco.mj_stateSize(self._models[0], _FULL_STATE)

    def advance(self, start: Array, command: Array, push: Array) -> Array:
        """States (cars, ticks, states) after each tick with the command held."""
        wheels, (cars, ticks, _) = self._wheels, push.shape
        row = np.zeros((cars, self._size))
        row[:, self._order] = start
        control = np.zeros((cars, ticks, self._models[0].nu))
        control[:, :, :wheels] = command[:, None, :wheels]
        control[:, :, wheels : 2 * wheels] = push
        control[:, :, 2 * wheels : wheels + command.shape[1]] = command[:, None, wheels:]
        self._batch.reset()
        self._batch.state[:, : self._size] = row
        rows = self._batch.rollout(ticks, control, record=[_FULL_STATE])[_FULL_STATE]
        states: Array = rows[:, :, self._order]
        return states


class _CompiledCars:
    """Cars stepped by the compiled equations."""

    def __init__(self, cars: Sequence[Car]) -> None:
        self._numbers, (self._low, self._high) = car_numbers(cars), target_limits(cars)

    def advance(self, start: Array, command: Array, push: Array) -> Array:
        """States (cars, ticks, states) after each tick with the command held."""
        states = np.empty((*push.shape[:2], start.shape[1]))
        target = np.clip(command, self._low, self._high)[:, None]
        surge = np.zeros(push.shape[:2])
        start, push = np.ascontiguousarray(start), np.ascontiguousarray(push)
        advance_cars(self._numbers, start, target, push, surge, states)
        return states
