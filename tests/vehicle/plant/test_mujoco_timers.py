"""Tests of the switch of MuJoCo's profiling timers."""

import mujoco
import numpy as np

from foreride.vehicle.load import load_vehicle
from foreride.vehicle.plant.mujoco_engine import build_model
from foreride.vehicle.plant.mujoco_timers import switch_timers_off


def _stepped(model: mujoco.MjModel) -> tuple[mujoco.MjData, np.ndarray]:
    data = mujoco.MjData(model)
    data.ctrl[:] = 1000.0
    for _ in range(50):
        mujoco.mj_step(model, data)
    return data, np.concatenate([data.qpos, data.qvel, data.act])


def test_timers_are_off_and_the_states_are_those_with_timers() -> None:
    model = build_model(load_vehicle("half"))
    assert switch_timers_off()
    off, without = _stepped(model)
    assert off.timer.duration.sum() == 0.0
    assert off.timer.number.sum() > 0
    mujoco.set_mjcb_time(None)  # the package's own clock
    try:
        on, with_timers = _stepped(model)
        assert on.timer.duration.sum() > 0.0
    finally:
        switch_timers_off()
    assert np.array_equal(without, with_timers)
