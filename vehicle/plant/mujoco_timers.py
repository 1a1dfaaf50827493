"""Profiling timers of MuJoCo, switched off.

MuJoCo's Python package installs a clock that the library reads around every part of every stage of a step,
for statistics in `MjData.timer`. For a car that is a quarter to nearly half of the time of a step. The C
interface has no timers while its callback `mjcb_time` is null, which `mujoco.set_mjcb_time` cannot say: None
restores the package's own clock. Nothing else depends on it: the states are the same bit for bit.
"""

import ctypes
from pathlib import Path

import mujoco

_LIBRARIES = ("libmujoco.so*", "libmujoco*.dylib", "mujoco.dll")


def switch_timers_off() -> bool:
    """Switch them off in this process; False, and they stay on, if the library is not found."""
    folder = Path(mujoco.__file__).parent
    for library in (found for pattern in _LIBRARIES for found in folder.glob(pattern)):
        try:
            ctypes.c_void_p.in_dll(ctypes.CDLL(str(library)), "mjcb_time").value = None
        except (OSError, ValueError):
            continue
        return True
    return False
