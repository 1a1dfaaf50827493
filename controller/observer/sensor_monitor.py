"""Sensor monitor: detection of silent, stuck and out-of-range readings, which are held back."""

from typing import Any, NamedTuple

import numpy as np

from foreride.controller.interface import ALL_SILENT
from foreride.files.jit import njit
from foreride.vehicle.plant.sensors import ROLL_RATE, Measurement, SensorNoise

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


class ValidatedReading(NamedTuple):
    """Validated reading: rejected channels are held at their last valid values.

    lost: of each channel, in the order body_acc (w), wheel_acc (w), rattle (w), pitch rate, speed, roll rate.
    faults: fault names, such as `rattle_m_0 stuck`; empty if all channels that control needs are valid.
    The roll gyro is not among them, as the observer does without it: while it is lost its reading is 0, since
    integrating a held rate would make the roll angle of a perception drift.
    """

    measurement: Measurement
    lost: tuple[bool, ...]
    faults: tuple[str, ...] = ()

    @property
    def is_incomplete(self) -> bool:
        """Whether any channel is lost."""
        return True in self.lost


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
        magnitudes = np.repeat(
            [MAX_MAGNITUDE["body_acc"], MAX_MAGNITUDE["wheel_acc"], MAX_MAGNITUDE["rattle_m"]], wheels
        )
        self._max_magnitude = np.array(
            [*magnitudes, MAX_MAGNITUDE["pitch_rate"], MAX_MAGNITUDE["speed_m_s"], MAX_MAGNITUDE["roll_rate"]]
        )
        self._none_lost = (False,) * len(self._max_magnitude)
        self._no_repeats = np.zeros(len(self._max_magnitude), dtype=int)
        self.reset()

    def reset(self) -> None:
        """Clear the history of readings."""
        self._last_valid = np.zeros(len(self._max_magnitude))
        self._previous = np.full(len(self._max_magnitude), np.nan)
        self._repeats = self._no_repeats

    def check(self, measurement: Measurement) -> ValidatedReading:
        """Return the validated reading."""
        values = measurement.channels()
        previous, self._previous = self._previous, values
        if _is_sound(values, previous, self._noisy, self._max_magnitude):
            self._repeats, self._last_valid = self._no_repeats, values
            return ValidatedReading(measurement, self._none_lost)
        return self._classify(measurement, values, self._noisy & (values == previous))

    def _classify(
        self, measurement: Measurement, values: np.ndarray, repeated: np.ndarray
    ) -> ValidatedReading:
        """Classify the faults of a reading; `repeated` marks the channels with their previous value."""
        silent = ~np.isfinite(values)
        impossible = np.abs(values) > self._max_magnitude  # false for NaN
        self._repeats = np.where(repeated, self._repeats + 1, 0)
        stuck = self._repeats >= STUCK_READINGS - 1
        lost = silent | impossible | stuck
        if not lost.any():
            self._last_valid = values
            return ValidatedReading(measurement, self._none_lost)
        self._last_valid = np.where(lost, self._last_valid, values)
        if lost[ROLL_RATE]:
            self._last_valid[ROLL_RATE] = 0.0
        held = Measurement.of_channels(measurement.time_s, self._last_valid)
        faults = self._faults(silent, impossible, stuck)
        return ValidatedReading(held, tuple(lost.tolist()), faults)

    def _faults(self, silent: np.ndarray, impossible: np.ndarray, stuck: np.ndarray) -> tuple[str, ...]:
        """Fault names of the channels that control needs."""
        fault_kinds = np.select([silent, impossible, stuck], ["silent", "out of range", "stuck"], "")[
            :ROLL_RATE
        ]
        if (fault_kinds != "").all():
            return (ALL_SILENT,)
        return tuple(
            f"{name} {reason}" for name, reason in zip(self._names, fault_kinds, strict=True) if reason
        )


@njit
def _is_sound(values: Any, previous: Any, noisy: Any, greatest: Any) -> bool:
    """Whether no value is out of range, NaN, or an unchanged one of a noisy sensor."""
    for i in range(len(values)):
        if not abs(values[i]) <= greatest[i] or (noisy[i] and values[i] == previous[i]):
            return False
    return True
