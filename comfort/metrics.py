"""The ride metrics of one run."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from comfort.measures import crest_factor, mtvv, vdv
from comfort.weighting import check_rate, weight
from files.errors import InputError

Array = NDArray[np.float64]
TYRE_LOAD_WEIGHT = 3.0  # (m/s^2)^2, the exchange rate rho of dynamic tyre load for comfort


def ride_metrics(
    rate_hz: float,
    *,
    seat_acc: ArrayLike,
    rattle: ArrayLike,
    tyre_force: ArrayLike,
    static_tyre_force: ArrayLike,
    damper_power: ArrayLike,
    stop_gap_m: ArrayLike,
    pitch_acc: ArrayLike | None = None,
    rho: float = TYRE_LOAD_WEIGHT,
) -> dict[str, float]:
    """Comfort, road holding and suspension use of one run, SI units.

    Seats are points of the sprung mass, where body heave and pitch combine: for a quarter car the mass
    itself, otherwise the places that the vehicle's parameters name (`seat_x_m`).

    Args:
        rate_hz: sampling rate, >= 500 Hz.
        seat_acc: (seats, n) vertical acceleration, m/s^2.
        rattle: (wheels, n) suspension travel from equilibrium, m.
        tyre_force: (wheels, n) vertical tyre force, static load included, >= 0, N.
        static_tyre_force: (wheels,) its value at rest, > 0, N.
        damper_power: (wheels, n) force times velocity taken up by the damper, W.
        stop_gap_m: travel from equilibrium to either bump stop, > 0, m; one value or (wheels,).
        pitch_acc: (n,) rad/s^2, or None for a car without pitch.
        rho: weight of tyre load in the objective, (m/s^2)^2, >= 0.

    Returns:
        wk_rms: m/s^2, root of the mean over seats of the squared Wk-weighted RMS.
        vdv (m/s^1.75), mtvv (m/s^2), crest_factor: Wk-weighted, of the worst seat each.
        peak_acc: m/s^2, largest |acceleration| of any seat, unweighted.
        pitch_acc_rms: rad/s^2, unweighted; 0 without pitch.
        rattle_rms, rattle_peak: m, over all wheels.
        stop_time: s during which any wheel is on a bump stop.
        tyre_load_rms: root of the mean over wheels (so over axles) of (dynamic / static tyre load)^2.
        lift_time: s during which any wheel carries nothing.
        damper_energy: J taken up by all dampers.
        objective: wk_rms^2 + rho tyre_load_rms^2, (m/s^2)^2.

    Raises InputError naming the argument if shapes disagree or a value is out of range.
    """
    check_rate(rate_hz)
    seats = _signals("seat_acc", seat_acc)
    n = seats.shape[1]
    travel = _signals("rattle", rattle, (None, n))
    force = _signals("tyre_force", tyre_force, travel.shape)
    power = _signals("damper_power", damper_power, travel.shape)
    static = np.asarray(static_tyre_force, float)
    if static.shape != (len(force),) or not np.all(static > 0):
        raise InputError(f"static_tyre_force must be {len(force)} values > 0, got {static.tolist()}")
    gap = np.asarray(stop_gap_m, float)
    if gap.shape not in ((), static.shape) or not (np.isfinite(gap) & (gap > 0)).all():
        raise InputError(f"stop_gap_m must be > 0, one value or {len(force)}, got {stop_gap_m!r}")
    if not (np.isfinite(rho) and rho >= 0):
        raise InputError(f"rho must be >= 0, got {rho!r}")
    pitch = (
        np.zeros((1, n))
        if pitch_acc is None
        else _signals("pitch_acc", np.asarray(pitch_acc, float)[None], (1, n))
    )

    weighted = weight(seats, rate_hz, "Wk")
    wk_rms, tyre_load_rms = _rms(weighted), _rms(force / static[:, None] - 1)
    values = {
        "wk_rms": wk_rms,
        "vdv": vdv(weighted, rate_hz, None).max(),
        "mtvv": mtvv(weighted, rate_hz, None).max(),
        "crest_factor": crest_factor(weighted, rate_hz, None).max(),
        "peak_acc": np.abs(seats).max(),
        "pitch_acc_rms": _rms(pitch),
        "rattle_rms": _rms(travel),
        "rattle_peak": np.abs(travel).max(),
        "stop_time": np.sum((np.abs(travel) > gap.reshape(-1, 1)).any(axis=0)) / rate_hz,
        "tyre_load_rms": tyre_load_rms,
        "lift_time": np.sum((force <= 0).any(axis=0)) / rate_hz,
        "damper_energy": np.sum(power) / rate_hz,
        "objective": wk_rms**2 + rho * tyre_load_rms**2,
    }
    return {name: float(value) for name, value in values.items()}


def _signals(name: str, value: ArrayLike, shape: tuple[int | None, int] | None = None) -> Array:
    """(rows, n) finite array; of the given shape, None for any number of rows."""
    signals = np.asarray(value, float)
    if signals.ndim != 2 or 0 in signals.shape:
        raise InputError(f"{name} must have shape (rows, samples), got {signals.shape}")
    if shape is not None and (shape[0] not in (None, signals.shape[0]) or shape[1] != signals.shape[1]):
        rows = "any number of" if shape[0] is None else shape[0]
        raise InputError(f"{name} must have {rows} rows of {shape[1]} samples, got shape {signals.shape}")
    if not np.all(np.isfinite(signals)):
        raise InputError(f"{name} must be finite, got nan or infinity")
    return signals


def _rms(signals: Array) -> float:
    return float(np.sqrt(np.mean(signals**2)))
