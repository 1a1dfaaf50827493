"""MuJoCo integration engines of the plant, which advance the car by ticks under given controls.

An engine holds the car's state as a row of numbers; `row[order]` is the state of `vehicle.equations`. The
control has a column for each damper's setting, each tyre's road force, each actuator's force and, for a car
that pitches, the pitching moment of the longitudinal acceleration.

`RolloutEngine` has MuJoCo integrate many ticks in one call; all forces are elements of the model, so each of
the four Runge-Kutta stages evaluates them. `SubsteppedEngine` serves dampers that are no MuJoCo elements: it
proceeds in substeps, over each of which the damper force is linearised about the rate expected at its
midpoint.
"""

from functools import lru_cache
from math import exp

import mujoco
import numpy as np
from mujoco.rollout import Rollout
from numpy.typing import NDArray

from foreride.files.errors import printable
from foreride.files.own_code import say_once
from foreride.vehicle.clock import STEP_S
from foreride.vehicle.equations import FLOATS
from foreride.vehicle.load import Car
from foreride.vehicle.plant.mjcf import car_xml
from foreride.vehicle.plant.mujoco_timers import switch_timers_off

Array = NDArray[np.float64]
_RATE_INCREMENT_M_S = 1e-4
mujoco.set_mju_user_warning(lambda text: say_once(f"MuJoCo {text}", f"MuJoCo: {printable(text)}"))
"""MuJoCo's own handler would append its warnings to MUJOCO_LOG.TXT in the user's folder."""
_FULL_STATE = mujoco.mjtState.mjSTATE_FULLPHYSICS
switch_timers_off()


def build_model(parameters: Car) -> mujoco.MjModel:
    """Build the MuJoCo model of a car.

    Gravity is balanced by preload, so that joint position zero is static equilibrium.
    """
    return mujoco.MjModel.from_xml_string(car_xml(parameters, STEP_S / parameters.corners[0].damper.substeps))


_shared_model = lru_cache(maxsize=8)(build_model)
"""The model of a car, which engines do not change; MuJoCo takes a millisecond to compile one."""


class RolloutEngine:
    """Engine for ideal dampers, on MuJoCo's own rollout."""

    def __init__(self, parameters: Car) -> None:
        model = _shared_model(parameters)
        self._model, self._only = model, mujoco.MjData(model)
        self._models, self._data = [self._model], [self._only]
        self._control = self._only.ctrl
        self._rollout = Rollout(nthread=0)  # on the calling thread
        self.size = mujoco.mj_stateSize(model, _FULL_STATE)
        self.order = _state_order(parameters)
        self._reached: Array | None = None  # the row that MuJoCo's data holds

    def advance(self, row: Array, control: Array, rows: Array) -> Array:
        """Fill rows (ticks, size) with the states after each tick under control (ticks, columns), from `row`.

        Returns the last one. For a single tick, rows may be (size,) and control (columns,); if `row` is the
        last one returned, this is faster as it needs no rollout.
        """
        if rows.ndim == 1 and row is self._reached:
            self._control[:] = control
            mujoco.mj_step(self._model, self._only)
            mujoco.mj_getState(self._model, self._only, rows, _FULL_STATE)
            self._reached = rows
            return rows
        if rows.ndim == 1:
            control, rows = control[None], rows[None]
        self._rollout.rollout(
            self._models,
            self._data,
            row[None],
            control[None],
            nstep=len(rows),
            state=rows[None],
            skip_checks=True,
        )
        self._reached = rows[-1]
        return self._reached


class SubsteppedEngine:
    """Engine for any damper, in substeps.

    A row holds MuJoCo's state, the dampers' settings and internal states, and the previous suspension rates.
    """

    def __init__(self, parameters: Car) -> None:
        self._model = _shared_model(parameters)
        self._data = mujoco.MjData(self._model)
        self._corners, self._wheels = parameters.corners, parameters.wheels
        self._bodies = len(parameters.generalised_mass)
        self._physics = mujoco.mj_stateSize(self._model, _FULL_STATE)
        self._substeps = self._corners[0].damper.substeps
        self._step_s = STEP_S / self._substeps
        depth = self._corners[0].damper.internal_states
        self._forces = self._wheels if self._corners[0].actuator else 0
        self.size = self._physics + self._wheels * (2 + depth)
        native = _state_order(parameters)
        moving = 2 * (self._bodies + self._wheels)
        settings = self._physics + np.arange(self._wheels)
        forces = native[moving + self._wheels :] - self._wheels  # MuJoCo has no damper activations here
        internal_states = self._physics + self._wheels + np.arange(self._wheels * depth)
        self.order = np.concatenate([native[:moving], settings, forces, internal_states])

    def advance(self, row: Array, control: Array, rows: Array) -> Array:
        """Fill rows (ticks, size) with the states after each tick under control (ticks, columns), from `row`.

        Returns the last one. For a single tick, rows may be (size,) and control (columns,).
        """
        control, rows = np.atleast_2d(control, rows)
        mujoco.mj_setState(self._model, self._data, row[: self._physics], _FULL_STATE)
        settings = row[self._physics : self._physics + self._wheels].tolist()
        flat, before = (
            row[self._physics + self._wheels : -self._wheels].tolist(),
            row[-self._wheels :].tolist(),
        )
        depth = len(flat) // self._wheels
        internal_states = [flat[i * depth : (i + 1) * depth] for i in range(self._wheels)]
        wheels, force = self._wheels, self._forces
        for tick, inputs in enumerate(control):
            asked = inputs[:wheels].tolist()
            self._data.ctrl[wheels : 2 * wheels + force] = inputs[wheels : 2 * wheels + force]
            self._data.ctrl[3 * wheels + force :] = inputs[2 * wheels + force :]
            for _ in range(self._substeps):
                before = self._substep(asked, settings, internal_states, before)
            mujoco.mj_getState(self._model, self._data, rows[tick, : self._physics], _FULL_STATE)
            rows[tick, self._physics :] = [
                *settings,
                *(value for part in internal_states for value in part),
                *before,
            ]
        return rows[-1]

    def _substep(self, asked: list, settings: list, internal_states: list, before: list) -> list:
        """Advance by one substep, settings and internal states in place; return the rates at its start."""
        step, wheels, control = self._step_s, self._wheels, self._data.ctrl
        travel, rate = self._strut_motion()
        for i, corner in enumerate(self._corners):
            target = min(max(asked[i], corner.damping_min_ns_m), corner.damping_max_ns_m)
            middle = settings[i] + (target - settings[i]) * (1.0 - exp(-0.5 * step / corner.damper_lag_s))
            expected = 1.5 * rate[i] - 0.5 * before[i]
            halfway = travel[i] + 0.5 * step * rate[i]
            normalised_setting, damper, states = (
                corner.normalised_setting(middle),
                corner.damper,
                internal_states[i],
            )
            if damper.internal_states:
                internal_states[i] = damper.advance(normalised_setting, halfway, expected, states, step)
                states = damper.midway(normalised_setting, halfway, expected, states, step)
            low, high = (
                damper.force(middle, normalised_setting, halfway, expected + nudge, states, FLOATS)
                for nudge in (-_RATE_INCREMENT_M_S, _RATE_INCREMENT_M_S)
            )
            slope = (low - high) / (2.0 * _RATE_INCREMENT_M_S)
            control[i] = slope
            control[2 * wheels + self._forces + i] = 0.5 * (low + high) + slope * expected
            settings[i] += (target - settings[i]) * (1.0 - exp(-step / corner.damper_lag_s))
        mujoco.mj_step(self._model, self._data)
        return rate

    def _strut_motion(self) -> tuple[list, list]:
        """Travel and rate of each suspension."""
        motions = []
        for values in (self._data.qpos.tolist(), self._data.qvel.tolist()):
            body, wheel = values[: self._bodies], values[self._bodies :]
            kinematic_rows = (corner.kinematic_row for corner in self._corners)
            motions.append(
                [
                    sum(map(float.__mul__, kinematic_row, body)) - w
                    for kinematic_row, w in zip(kinematic_rows, wheel, strict=True)
                ]
            )
        return motions[0], motions[1]


def _state_order(parameters: Car) -> NDArray[np.int64]:
    """Indices into MuJoCo's state [time, positions, velocities, activations] of the equations' x."""
    freedoms = len(parameters.generalised_mass) + parameters.wheels
    motion = [index for i in range(freedoms) for index in (1 + i, 1 + freedoms + i)]
    activations = parameters.wheels * (1 if parameters.corners[0].actuator is None else 2)
    return np.array(motion + [1 + 2 * freedoms + i for i in range(activations)])
