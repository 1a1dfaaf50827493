"""Fleet simulation for parameter studies: many cars with parameters of their own at one speed on one road.

MuJoCo steps them in threads; the results are bit-identical for any number of threads and equal to those of
`vehicle.plant.plant.Plant` for the same commands.
"""

from collections.abc import Sequence

import mujoco
import numpy as np
from mujoco.batch import Batch
from numpy.typing import ArrayLike, NDArray

from foreride.files.errors import InputError
from foreride.vehicle.clock import RATE_HZ
from foreride.vehicle.dampers.damper import IdealDamper
from foreride.vehicle.equations import input_size
from foreride.vehicle.load import Car
from foreride.vehicle.plant.mujoco_engine import RolloutEngine, build_model
from foreride.vehicle.plant.plant import standstill_state
from foreride.vehicle.speed_profile import ConstantSpeed
from foreride.vehicle.state import EffectiveProfile, VehicleState, observe, road_forces, road_under

Array = NDArray[np.float64]
_FULL_STATE = mujoco.mjtState.mjSTATE_FULLPHYSICS


class Fleet:
    """Cars of one kind (all quarter, all half or all full cars) with ideal dampers, simulated together.

    threads: 0 uses all processors. Raises InputError for mixed kinds and for other dampers.
    """

    def __init__(self, cars: Sequence[Car], threads: int = 0) -> None:
        shapes = {(car.kind, input_size(car)) for car in cars}
        if len(shapes) != 1:
            raise InputError(f"cars must be of one kind and at least one, got {len(shapes)} kinds")
        if not all(isinstance(corner.damper, IdealDamper) for car in cars for corner in car.corners):
            raise InputError("cars must have ideal dampers to be stepped together")
        self.cars = tuple(cars)
        self._models = [build_model(car) for car in cars]
        self._batch = Batch(self._models[0], len(cars), nthread=threads, persistent=True)
        self._batch.set_models(self._models)
        self._engine = RolloutEngine(cars[0])

    def drive(
        self,
        profiles: Sequence[EffectiveProfile],
        x_m: float,
        speed_m_s: float,
        command: ArrayLike,
        ticks: int,
    ) -> Array:
        """Return the states (cars, ticks + 1, states) in the order of `vehicle.equations`, standstill first.

        profiles: one for each wheel of a car. command: (cars, inputs), held over the drive.
        """
        cars, wheels = len(self.cars), self.cars[0].wheels
        commands = np.asarray(command, float)
        if commands.shape != (cars, input_size(self.cars[0])):
            expected_shape = (cars, input_size(self.cars[0]))
            raise InputError(f"command must have shape {expected_shape}, got {commands.shape}")
        row = np.zeros((cars, self._engine.size))
        initial_states = (standstill_state(car, road_under(car, profiles, x_m, 0.0)[0]) for car in self.cars)
        row[:, self._engine.order] = list(initial_states)
        control = np.zeros((cars, ticks, self._models[0].nu))
        control[:, :, :wheels] = commands[:, None, :wheels]
        control[:, :, wheels : 2 * wheels] = self._road_force(profiles, x_m, speed_m_s, ticks)
        control[:, :, 2 * wheels : wheels + commands.shape[1]] = commands[:, None, wheels:]
        self._batch.reset()
        self._batch.state[:, : row.shape[1]] = row
        rows = self._batch.rollout(ticks, control, record=[_FULL_STATE])[_FULL_STATE]
        states = np.concatenate([row[:, None], rows], axis=1)
        return states[:, :, self._engine.order]

    def observe(
        self,
        car: int,
        states: Array,
        profiles: Sequence[EffectiveProfile],
        x_m: float,
        speed_m_s: float,
        command: ArrayLike,
    ) -> VehicleState:
        """Return all signals of one car, computed from the states that `drive` returned."""
        time = np.arange(states.shape[1]) / RATE_HZ
        travel = ConstantSpeed(speed_m_s).ahead(x_m, 0, len(time) - 1).edges_m
        commands = np.tile(np.asarray(command, float)[car][:, None], len(time))
        road = road_under(self.cars[car], profiles, travel, speed_m_s)
        return observe(
            self.cars[car], time, travel, np.full(len(time), speed_m_s), states[car].T, commands, road
        )

    def _road_force(
        self, profiles: Sequence[EffectiveProfile], x_m: float, speed_m_s: float, ticks: int
    ) -> Array:
        """Tyre forces due to the road's motion, (cars, ticks, wheels)."""
        stretch = ConstantSpeed(speed_m_s).ahead(x_m, 0, ticks)
        return np.stack([np.stack(road_forces(car, profiles, stretch), axis=1) for car in self.cars])
