"""Time window of a run around the road's features, for figures."""

import numpy as np

from foreride.scenarios.definition.clock import ticks
from foreride.scenarios.simulation.simulate import Run


def event_window(run: Run, before_s: float = 1.2, after_s: float = 1.8) -> tuple[int, int]:
    """First and last tick around the features of the road; the whole run if there are none."""
    scenario = run.case.scenario
    total = len(run.signals["time_s"])
    if not scenario.road.features:
        return 0, total - 1
    axles = scenario.vehicle.parameters.axle_x_m
    first = min(feature.start_m for feature in scenario.road.features) - max(axles)
    last = max(feature.end_m for feature in scenario.road.features) - min(axles)
    start = int(np.searchsorted(run.signals["x_m"], first)) - ticks(before_s)
    end = int(np.searchsorted(run.signals["x_m"], last)) + ticks(after_s)
    return max(start, 0), min(end, total - 1)
