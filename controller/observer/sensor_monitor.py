"""Sensor monitor: detection of silent, stuck and out-of-range readings, which are held back."""

from dataclasses import dataclass, replace

import numpy as np

from foreride.controller.interface import ALL_SILENT
from foreride.vehicle.plant.sensors import Measurement, SensorNoise

STUCK_READINGS = 4
"""Number of equal consecutive readings after which a noisy sensor counts as stuck."""
MAX_MAGNITUDE = {
    "body_acc": 150.0,
    "wheel_acc": 2000.0,
    "rattle_m": 0.4,
    "pitch_rate": 10.0,
    "speed_m_s": 110.0,
    "roll_rate": 10.0,
}
"""Largest plausible magnitude of each channel, SI units."""


@dataclass(frozen=True, eq=False)
class ValidatedReading:
    """Validated reading: rejected channels are held at their last valid values.

    lost: of each channel, in the order body_acc (w), wheel_acc (w), rattle (w), pitch rate, speed, roll rate.
    faults: fault names, such as `rattle_m_0 stuck`; empty if all channels that control needs are valid.
    The roll gyro is not among them, as only a perception reads it: while it is lost its reading is 0, since
    integrating a held rate would make the roll angle drift.
    """

    measurement: Measurement
    lost: tuple[bool, ...]
    faults: tuple[str, ...] = ()


class SensorMonitor:
    """Validator of consecutive readings, for a car with `wheels` wheels and sensors of this noise."""

    def __init__(self, wheels: int, noise: SensorNoise):
        self._wheels = wheels
        noisy = [noise.body_density_m_s2, noise.wheel_density_m_s2, noise.rattle_m]
        gyros = noise.pitch_rate_density_rad_s, noise.roll_rate_density_rad_s if wheels > 2 else 0.0
        self._noisy = np.array([*np.repeat(noisy, wheels), gyros[0], noise.speed_m_s, gyros[1]]) > 0.0
        self._names = [
            f"{name}_{wheel}" for name in ("body_acc", "wheel_acc", "rattle_m") for wheel in range(wheels)
        ]
        self._names += ["pitch_rate", "speed_m_s"]
        most = np.repeat(
            [MAX_MAGNITUDE["body_acc"], MAX_MAGNITUDE["wheel_acc"], MAX_MAGNITUDE["rattle_m"]], wheels
        )
        self._most = np.array(
            [*most, MAX_MAGNITUDE["pitch_rate"], MAX_MAGNITUDE["speed_m_s"], MAX_MAGNITUDE["roll_rate"]]
        )
        self._sound = (False,) * len(self._most)
        self._none = np.zeros(len(self._most), dtype=int)
        self.reset()

    def reset(self) -> None:
        """Clear the history of readings."""
        self._held = np.zeros(len(self._most))
        self._before = np.full(len(self._most), np.nan)
        self._equal = self._none

    def check(self, measurement: Measurement) -> ValidatedReading:
        """Return the validated reading."""
        m = measurement
        moved = [m.pitch_rate, m.speed_m_s, m.roll_rate]
        values = np.concatenate([m.body_acc, m.wheel_acc, m.rattle_m, moved])
        equal = self._noisy & (values == self._before)
        self._before = values
        if not equal.any() and (np.abs(values) <= self._most).all():  # false for NaN
            self._equal, self._held = self._none, values
            return ValidatedReading(measurement, self._sound)
        return self._classify(measurement, values, equal)

    def _classify(self, measurement: Measurement, values: np.ndarray, equal: np.ndarray) -> ValidatedReading:
        """Classify the faults of a reading; `equal` marks the channels that repeat their previous value."""
        silent = ~np.isfinite(values)
        impossible = np.abs(values) > self._most  # false for NaN
        self._equal = np.where(equal, self._equal + 1, 0)
        stuck = self._equal >= STUCK_READINGS - 1
        lost = silent | impossible | stuck
        if not lost.any():
            self._held = values
            return ValidatedReading(measurement, self._sound)
        self._held = np.where(lost, self._held, values)
        if lost[-1]:
            self._held[-1] = 0.0
        faults = self._faults(silent, impossible, stuck)
        return ValidatedReading(self._hold_invalid(measurement), tuple(lost.tolist()), faults)

    def _faults(self, silent: np.ndarray, impossible: np.ndarray, stuck: np.ndarray) -> tuple[str, ...]:
        """Fault names of the channels that control needs."""
        why = np.select([silent, impossible, stuck], ["silent", "out of range", "stuck"], "")[:-1]
        if (why != "").all():
            return (ALL_SILENT,)
        return tuple(f"{name} {reason}" for name, reason in zip(self._names, why, strict=True) if reason)

    def _hold_invalid(self, measurement: Measurement) -> Measurement:
        w, held = self._wheels, self._held
        return replace(
            measurement,
            body_acc=held[:w],
            wheel_acc=held[w : 2 * w],
            rattle_m=held[2 * w : 3 * w],
            pitch_rate=float(held[-3]),
            speed_m_s=float(held[-2]),
            roll_rate=float(held[-1]),
        )
