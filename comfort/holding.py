"""Road holding, suspension travel and damper work of each wheel.

Signals have time on the last axis; leading axes are wheels, runs, or both. SI units.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from foreride.files.errors import InputError

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


def relative_load(tyre_force: ArrayLike, static_tyre_force: ArrayLike) -> Array:
    """Dynamic over static tyre load, (..., n): 0 at rest, -1 with the wheel off the ground.

    tyre_force: (..., n), static load included, N. static_tyre_force: (...) its value at rest, > 0, N.
    """
    force, static = np.asarray(tyre_force, float), np.asarray(static_tyre_force, float)
    if not np.all(static > 0):
        raise InputError(f"static_tyre_force must be > 0, got {static.tolist()}")
    return force / static[..., None] - 1


def load_rms(tyre_force: ArrayLike, static_tyre_force: ArrayLike) -> Array:
    """RMS of the relative dynamic tyre load (dynamic load coefficient)."""
    return np.sqrt(np.mean(relative_load(tyre_force, static_tyre_force) ** 2, axis=-1))


def load_percentile(tyre_force: ArrayLike, static_tyre_force: ArrayLike, percent: float = 95.0) -> Array:
    """Magnitude of relative dynamic tyre load that is not exceeded for `percent` of the time."""
    if not 0 <= percent <= 100:
        raise InputError(f"percent must lie in 0 ... 100, got {percent!r}")
    return np.percentile(np.abs(relative_load(tyre_force, static_tyre_force)), percent, axis=-1)


def lift_time(tyre_force: ArrayLike, rate: float) -> Array:
    """Time during which a wheel carries no load, s."""
    return np.sum(np.asarray(tyre_force, float) <= 0, axis=-1) / rate


def rattle_rms(rattle: ArrayLike) -> Array:
    """RMS of suspension travel from equilibrium, m."""
    return np.sqrt(np.mean(np.asarray(rattle, float) ** 2, axis=-1))


def rattle_peak(rattle: ArrayLike) -> Array:
    """Peak suspension travel from equilibrium in either direction, m: the rattle space required."""
    return np.max(np.abs(np.asarray(rattle, float)), axis=-1)


def stop_contact(rattle: ArrayLike, stop_gap_m: ArrayLike, rebound_gap_m: ArrayLike | None = None) -> Mask:
    """Mask of bump- or rebound-stop contact, (..., n).

    rattle: (..., n), positive in extension, m. stop_gap_m: (...) travel from equilibrium to the bump stop,
    > 0; rebound_gap_m: to the rebound stop, the same where None.
    """
    travel, bump = np.asarray(rattle, float), np.asarray(stop_gap_m, float)
    rebound = bump if rebound_gap_m is None else np.asarray(rebound_gap_m, float)
    for name, gap in (("stop_gap_m", bump), ("rebound_gap_m", rebound)):
        if not np.all(np.isfinite(gap) & (gap > 0)):
            raise InputError(f"{name} must be > 0, got {gap.tolist()}")
    return (travel < -bump[..., None]) | (travel > rebound[..., None])


def stop_time(
    rattle: ArrayLike, stop_gap_m: ArrayLike, rate: float, rebound_gap_m: ArrayLike | None = None
) -> Array:
    """Time in contact with a bump or rebound stop, s."""
    return np.sum(stop_contact(rattle, stop_gap_m, rebound_gap_m), axis=-1) / rate


def damper_power(force: ArrayLike, velocity: ArrayLike) -> Array:
    """Power absorbed by a damper, W, from its force on the body and its velocity (extension positive)."""
    return -np.asarray(force, float) * np.asarray(velocity, float)


def dissipated_energy(power: ArrayLike, rate: float) -> Array:
    """Energy dissipated by a damper, J: the time integral of its power."""
    return np.sum(np.asarray(power, float), axis=-1) / rate
