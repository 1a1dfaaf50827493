"""Fault injection: sensor faults, preview faults and late controller answers, within time windows."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from foreride.preview.road_preview import RoadPreview
from foreride.scenarios.definition.faults import Fault, LateAnswers, PreviewFault, SensorFault
from foreride.vehicle.plant.sensors import Measurement

LATE_ANSWER = "late answer"
_IMPLAUSIBLE_HEIGHT_M = 3.0


class Faults:
    """Fault injector for one drive."""

    def __init__(self, faults: Sequence[Fault], rng: np.random.Generator):
        self._faults, self._rng = faults, rng
        self._reading: Measurement | None = None
        self._preview: RoadPreview | None = None

    def reading(self, measurement: Measurement) -> Measurement:
        """Return the reading as delivered under the active faults."""
        delivered = measurement
        for fault in self._faults:
            if isinstance(fault, SensorFault) and _active(fault, measurement.time_s):
                delivered = _apply_sensor_fault(delivered, fault, self._reading)
        self._reading = delivered
        return delivered

    def preview(self, preview: RoadPreview | None, time_s: float) -> RoadPreview | None:
        """Return the preview as delivered under the active faults."""
        if preview is None:
            return None
        for fault in self._faults:
            if isinstance(fault, PreviewFault) and _active(fault, time_s):
                if fault.mode == "absurd":
                    return replace(preview, height_m=preview.height_m + _IMPLAUSIBLE_HEIGHT_M)
                preview = self._preview or preview
        self._preview = preview
        return preview

    def late(self, time_s: float) -> bool:
        """Whether the present controller answer comes too late."""
        if not self._faults:
            return False
        risks = [f.probability for f in self._faults if isinstance(f, LateAnswers) and _active(f, time_s)]
        return any(self._rng.random() < risk for risk in risks)


def _active(fault: Fault, time_s: float) -> bool:
    return fault.start_s <= time_s < fault.start_s + fault.duration_s


def _apply_sensor_fault(
    measurement: Measurement, fault: SensorFault, before: Measurement | None
) -> Measurement:
    channels = ("body_acc", "wheel_acc", "rattle_m", "pitch_rate", "speed_m_s", "roll_rate")
    changed: dict[str, Any] = {}
    for name in channels if fault.channel == "all" else (fault.channel,):
        value, last = getattr(measurement, name), getattr(before or measurement, name)
        spoilt = last if fault.mode == "stuck" else np.full_like(value, np.nan)
        if np.ndim(value) == 0:
            changed[name] = float(spoilt)
        elif fault.channel == "all":
            changed[name] = spoilt
        else:
            changed[name] = np.where(np.arange(len(value)) == fault.wheel, spoilt, value)
    return replace(measurement, **changed)
