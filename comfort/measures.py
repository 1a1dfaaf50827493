"""Vibration measures and comfort reactions of ISO 2631-1:1997.

Accelerations are in m/s^2 with time on the last axis, sampled at `rate` Hz; leading axes are independent
signals. Every measure takes `weighting`, a name in `comfort.weighting.WEIGHTINGS`, or None for an
acceleration that is already weighted, and raises InputError as `comfort.weighting.weight` does.
"""

from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from foreride.comfort.weighting import weight
from foreride.files.errors import InputError

Array = NDArray[np.float64]
Averaging = Literal["linear", "exponential"]

COMFORT_BANDS: dict[str, tuple[float, float]] = {
    "not uncomfortable": (0.0, 0.315),
    "a little uncomfortable": (0.315, 0.63),
    "fairly uncomfortable": (0.5, 1.0),
    "uncomfortable": (0.8, 1.6),
    "very uncomfortable": (1.25, 2.5),
    "extremely uncomfortable": (2.0, np.inf),
}
"""Likely reactions in public transport by overall weighted RMS, m/s^2; they overlap (annex C, C.2.3)."""


def weighted_rms(acc: ArrayLike, rate: float, weighting: str | None = "Wk") -> Array:
    """RMS of the weighted acceleration over the whole duration (m/s^2; 6.1)."""
    return np.sqrt(np.mean(weight(acc, rate, weighting) ** 2, axis=-1))


def running_rms(
    acc: ArrayLike,
    rate: float,
    weighting: str | None = "Wk",
    window_s: float = 1.0,
    averaging: Averaging = "linear",
) -> Array:
    """Running RMS at every sample (m/s^2; 6.3.1), with zero signal before the start.

    Averaging over the last `window_s` (linear, equation 2) or with exponential memory of that time constant
    (equation 3).
    """
    if not (np.isfinite(window_s) and window_s * rate >= 1):
        raise InputError(f"window_s must be at least one sample, got {window_s!r}")
    if averaging not in ("linear", "exponential"):
        raise InputError(f"averaging must be linear or exponential, got {averaging!r}")
    power = weight(acc, rate, weighting) ** 2
    if averaging == "exponential":
        from scipy.signal import lfilter  # slow to import

        memory = np.exp(-1.0 / (window_s * rate))
        return np.sqrt(lfilter([1.0 - memory], [1.0, -memory], power, axis=-1))
    energy, count = np.cumsum(power, axis=-1, out=power), round(window_s * rate)
    in_window = energy.copy()
    in_window[..., count:] -= energy[..., :-count]
    return np.sqrt(np.maximum(in_window, 0.0, out=in_window) / count)


def mtvv(acc: ArrayLike, rate: float, weighting: str | None = "Wk", averaging: Averaging = "linear") -> Array:
    """Maximum transient vibration value: maximum of the running RMS over 1 s (m/s^2; 6.3.1)."""
    return running_rms(acc, rate, weighting, averaging=averaging).max(axis=-1)


def vdv(acc: ArrayLike, rate: float, weighting: str | None = "Wk") -> Array:
    """Vibration dose value: fourth root of the time integral of a_w^4 (m/s^1.75; 6.3.2)."""
    power = np.square(weight(acc, rate, weighting))
    return (np.sum(power * power, axis=-1) / rate) ** 0.25  # numpy's ** 4 is ten times slower


def evdv(acc: ArrayLike, rate: float, weighting: str | None = "Wk") -> Array:
    """Estimated vibration dose value 1.4 a_w T^(1/4) (m/s^1.75; annex B, B.3.2).

    For vibration of a steady character; it underestimates the VDV of shocks.
    """
    rms = weighted_rms(acc, rate, weighting)
    return 1.4 * rms * (np.shape(acc)[-1] / rate) ** 0.25


def msdv(acc: ArrayLike, rate: float, weighting: str | None = "Wf") -> Array:
    """Motion sickness dose value: root of the time integral of a_w^2 (m/s^1.5; annex D, D.1.1)."""
    return np.sqrt(np.sum(weight(acc, rate, weighting) ** 2, axis=-1) / rate)


def crest_factor(acc: ArrayLike, rate: float, weighting: str | None = "Wk") -> Array:
    """Peak over RMS of the weighted acceleration (6.2.1); 0 for a signal that is zero throughout.

    Above 9 the RMS alone is not sufficient, and MTVV or VDV is required in addition (6.2.2).
    """
    weighted = weight(acc, rate, weighting)
    rms = np.sqrt(np.mean(weighted**2, axis=-1))
    return np.max(np.abs(weighted), axis=-1) / np.where(rms > 0, rms, np.inf)


def comfort_bands(total_m_s2: float) -> tuple[str, ...]:
    """All reactions whose band contains this overall weighted RMS, mildest first; the bands overlap."""
    if not (np.isfinite(total_m_s2) and total_m_s2 >= 0):
        raise InputError(f"total_m_s2 must be finite and >= 0, got {total_m_s2!r}")
    return tuple(name for name, (low, high) in COMFORT_BANDS.items() if low <= total_m_s2 < high)
