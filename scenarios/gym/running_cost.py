"""Running cost of a drive, whose mean over time is the objective J."""

import numpy as np

from foreride.comfort.holding import relative_load
from foreride.comfort.weighting import StreamedWeighting
from foreride.scenarios.definition.clock import TICKS_PER_SECOND
from foreride.vehicle.state import VehicleState


class RunningCost:
    """Squared Wk-weighted acceleration, mean over seats, plus rho times the squared relative tyre load.

    Its mean over all ticks is J of `comfort.ride_metrics`.
    """

    def __init__(self, tyre_load_weight: float) -> None:
        """Start at rest; tyre_load_weight: rho, (m/s²)²."""
        self._rho = tyre_load_weight
        self._weighting = StreamedWeighting(TICKS_PER_SECOND)

    def add(self, signals: VehicleState) -> float:
        """Sum of the cost over the next ticks, (m/s²)²."""
        weighted = self._weighting(signals.seat_acc)
        load = relative_load(signals.tyre_force, np.asarray(signals.static_tyre_force)[:, 0])
        per_tick = np.mean(weighted**2, axis=0) + self._rho * np.mean(load**2, axis=0)
        return float(per_tick.sum())
