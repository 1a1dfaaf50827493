"""Ride metrics of a drive so far, from the signals of every tick as they come."""

from typing import Any

import numpy as np

from foreride.comfort.holding import relative_load
from foreride.comfort.weighting import StreamedWeighting
from foreride.scenarios.definition.clock import TICKS_PER_SECOND
from foreride.vehicle.state import VehicleState


class RunningMetrics:
    """Sums of squares since the start; their means are those of `comfort.ride_metrics`."""

    def __init__(self, tyre_load_weight: float) -> None:
        """Start with nothing; tyre_load_weight: rho, (m/s²)²."""
        self._rho = tyre_load_weight
        self._weighting = StreamedWeighting(TICKS_PER_SECOND)
        self._comfort, self._load, self._travel, self._ticks = 0.0, 0.0, 0.0, 0

    def add(self, signals: VehicleState) -> float:
        """Add the next ticks, signals with a trailing axis of time; return the sum of their cost."""
        comfort = float(np.mean(self._weighting(signals.seat_acc) ** 2, axis=0).sum())
        static = np.asarray(signals.static_tyre_force)[:, 0]
        load = float(np.mean(relative_load(signals.tyre_force, static) ** 2, axis=0).sum())
        self._comfort += comfort
        self._load += load
        self._travel += float(np.mean(np.asarray(signals.rattle_m) ** 2, axis=0).sum())
        self._ticks += np.shape(signals.rattle_m)[-1]
        return comfort + self._rho * load

    def values(self) -> dict[str, float]:
        """Metrics so far, by their names."""
        count = max(1, self._ticks)
        comfort, load, travel = self._comfort / count, self._load / count, self._travel / count
        found = {"wk_rms": comfort**0.5, "tyre_load_rms": load**0.5, "rattle_rms": travel**0.5}
        return found | {"objective": comfort + self._rho * load}

    def state(self) -> dict[str, Any]:
        """Sums and filter states, as numbers and lists."""
        sums = {"comfort": self._comfort, "load": self._load, "travel": self._travel}
        return sums | {"ticks": self._ticks, "weighting": self._weighting.state()}

    def restore(self, state: dict[str, Any]) -> None:
        """Continue from a state saved before."""
        self._comfort, self._load = float(state["comfort"]), float(state["load"])
        self._travel, self._ticks = float(state["travel"]), int(state["ticks"])
        self._weighting.restore(state["weighting"])
