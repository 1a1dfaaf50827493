"""Ride metrics of one or many runs: comfort, road holding, suspension travel, damper work, objective."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from foreride.comfort.holding import dissipated_energy, relative_load, stop_contact
from foreride.comfort.measures import crest_factor, evdv, mtvv, vdv
from foreride.comfort.occupant import SeatedPerson, axis_values, body_motion, total_value
from foreride.comfort.registry import METRICS
from foreride.comfort.weighting import check_rate, weight
from foreride.files.errors import InputError

Array = NDArray[np.float64]
TYRE_LOAD_WEIGHT = 3.0  # (m/s^2)^2, weight rho of the dynamic tyre load relative to comfort


def ride_metrics(
    rate_hz: float,
    *,
    seat_acc: ArrayLike,
    rattle: ArrayLike,
    tyre_force: ArrayLike,
    static_tyre_force: ArrayLike,
    damper_power: ArrayLike,
    stop_gap_m: ArrayLike,
    rebound_gap_m: ArrayLike | None = None,
    pitch_acc: ArrayLike | None = None,
    roll_acc: ArrayLike | None = None,
    rho: float = TYRE_LOAD_WEIGHT,
) -> dict[str, Any]:
    """Compute foreride's own METRICS of one run, a float each, or of many runs, an array (runs,) each.

    Seats are points of the sprung mass, where heave, pitch and roll combine: for a quarter car the mass
    itself, otherwise the positions in the vehicle's parameters. All signals may have one leading axis of
    runs, the same in all of them.

    Args:
        rate_hz: sampling rate, >= 500 Hz.
        seat_acc: (seats, n) vertical acceleration, m/s^2.
        rattle: (wheels, n) suspension travel from equilibrium, positive in extension, m.
        tyre_force: (wheels, n) vertical tyre force, static load included, >= 0, N.
        static_tyre_force: (wheels,) its value at rest, > 0, N.
        damper_power: (wheels, n) force times velocity absorbed by the damper, W.
        stop_gap_m: travel from equilibrium to the bump stop, > 0, m; one value or (wheels,).
        rebound_gap_m: the same to the rebound stop; None where it is equal.
        pitch_acc, roll_acc: (n,) rad/s^2, or None for a car without pitch or roll.
        rho: weight of tyre load in the objective, (m/s^2)^2, >= 0.

    Raises InputError naming the argument if shapes disagree or a value is out of range.
    """
    check_rate(rate_hz)
    seats = _signals("seat_acc", seat_acc)
    runs, n = seats.shape[:-2], seats.shape[-1]
    travel = _signals("rattle", rattle, (*runs, None, n))
    force = _signals("tyre_force", tyre_force, travel.shape)
    power = _signals("damper_power", damper_power, travel.shape)
    pitch, roll = (
        _rotation(name, acc, (*runs, n)) for name, acc in (("pitch_acc", pitch_acc), ("roll_acc", roll_acc))
    )
    if not (np.isfinite(rho) and rho >= 0):
        raise InputError(f"rho must be >= 0, got {rho!r}")
    load = relative_load(force, _each_wheel("static_tyre_force", static_tyre_force, force))
    bump = _each_wheel("stop_gap_m", stop_gap_m, force)
    rebound = bump if rebound_gap_m is None else _each_wheel("rebound_gap_m", rebound_gap_m, force)

    values = _comfort(rate_hz, seats, pitch, roll) | _holding(rate_hz, force, load, travel, power)
    values["stop_time"] = stop_contact(travel, bump, rebound).any(axis=-2).sum(axis=-1) / rate_hz
    values["objective"] = values["wk_rms"] ** 2 + rho * values["tyre_load_rms"] ** 2
    return {name: values[name] if runs else float(values[name]) for name in METRICS.own}


def _comfort(rate: float, seats: Array, pitch: Array, roll: Array) -> dict[str, Array]:
    """Comfort metrics: `seats` (..., seats, n), rotations (..., n)."""
    # The seat is rigidly attached: its motion and the rotations give those of backrest and feet.
    # Pitch and roll axes are taken at seat height, where a car's centre of gravity is.
    motions = (body_motion(seats[..., seat, :], pitch, roll) for seat in range(seats.shape[-2]))
    by_seat = [axis_values(rate, SeatedPerson.at(0.0), *motion) for motion in motions]
    by_axis = {axis: np.stack([values[axis] for values in by_seat], axis=-1) for axis in by_seat[0]}
    weighted = weight(seats, rate, "Wk")
    return {
        "wk_rms": _rms(weighted),
        "vdv": vdv(weighted, rate, None).max(axis=-1),
        "evdv": evdv(weighted, rate, None).max(axis=-1),
        "mtvv": mtvv(weighted, rate, None).max(axis=-1),
        "crest_factor": crest_factor(weighted, rate, None).max(axis=-1),
        "vibration_total": total_value(by_axis).max(axis=-1),
        "peak_acc": np.abs(seats).max(axis=(-2, -1)),
        "pitch_acc_rms": np.sqrt(np.mean(pitch**2, axis=-1)),
        "roll_acc_rms": np.sqrt(np.mean(roll**2, axis=-1)),
    }


def _holding(rate: float, force: Array, load: Array, travel: Array, power: Array) -> dict[str, Array]:
    """Road-holding, travel and damper metrics; all signals (..., wheels, n)."""
    return {
        "rattle_rms": _rms(travel),
        "rattle_peak": np.abs(travel).max(axis=(-2, -1)),
        "tyre_load_rms": _rms(load),
        "tyre_load_p95": np.percentile(np.abs(load), 95, axis=-1).max(axis=-1),
        "lift_time": (force <= 0).any(axis=-2).sum(axis=-1) / rate,
        "damper_energy": dissipated_energy(power, rate).sum(axis=-1),
        "damper_power_peak": power.max(axis=(-2, -1)),
    }


def _signals(name: str, value: ArrayLike, shape: tuple[int | None, ...] | None = None) -> Array:
    """Check for a finite (rows, n) or (runs, rows, n) array of the given shape, None for any row count."""
    signals = np.asarray(value, float)
    if signals.ndim not in (2, 3) or 0 in signals.shape:
        raise InputError(f"{name} must have shape (rows, samples), got {signals.shape}")
    if shape is not None and not _shape_matches(signals.shape, shape):
        rows = "any number of" if shape[-2] is None else shape[-2]
        runs = f"{shape[0]} runs of " if len(shape) == 3 else ""
        raise InputError(f"{name} must have {runs}{rows} rows of {shape[-1]} samples, got {signals.shape}")
    if not np.all(np.isfinite(signals)):
        raise InputError(f"{name} must be finite, got nan or infinity")
    return signals


def _shape_matches(found: tuple[int, ...], wanted: tuple[int | None, ...]) -> bool:
    pairs = zip(found, wanted, strict=True) if len(found) == len(wanted) else [(0, 1)]
    return all(want is None or have == want for have, want in pairs)


def _each_wheel(name: str, value: ArrayLike, force: Array) -> Array:
    """Check for one value > 0 per wheel: (wheels,)."""
    values, wheels = np.asarray(value, float), force.shape[-2]
    single = values.shape == () and name != "static_tyre_force"
    if not (single or values.shape == (wheels,)) or not (np.isfinite(values) & (values > 0)).all():
        raise InputError(f"{name} must be {wheels} values > 0, got {values.tolist()}")
    return np.broadcast_to(values, (wheels,))


def _rotation(name: str, acc: ArrayLike | None, shape: tuple[int, ...]) -> Array:
    if acc is None:
        return np.zeros(shape)
    rotation = np.asarray(acc, float)
    if rotation.shape != shape or not np.all(np.isfinite(rotation)):
        raise InputError(f"{name} must be {shape[-1]} finite samples, got shape {rotation.shape}")
    return rotation


def _rms(signals: Array) -> Array:
    return np.sqrt(np.mean(signals**2, axis=(-2, -1)))
