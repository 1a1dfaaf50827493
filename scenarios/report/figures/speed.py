"""Figure of comfort against trip time for speed policies."""

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from foreride.scenarios.report.figures.files import WIDTH_IN, styled

Array = NDArray[np.float64]
_STYLES = {"constant speed": ("#70767d", "s"), "reactive planner": ("#1fa35c", "^")}
_PREVIEW = "#1a6fc4", "o"


def speed_figure(fronts: Mapping[str, Mapping[str, Array]]) -> Figure:
    """Points (n, 2) of trip time and ride, relative to the cruise, by policy; a panel per controller."""
    with styled():
        figure = Figure(figsize=(WIDTH_IN, 3.6), layout="constrained")
        axes = figure.subplots(1, len(fronts), sharey=True, squeeze=False)[0]
        for axis, (controller, policies) in zip(axes, fronts.items(), strict=True):
            for name, points in policies.items():
                colour, marker = _STYLES.get(name, _PREVIEW)
                time = 100.0 * (points[:, 0] - 1.0)
                axis.plot(time, points[:, 1], color=colour, marker=marker, markersize=4, label=name)
            axis.set_title(controller)
            axis.set_xlabel("trip time lost, %")
            axis.set_ylim(bottom=0.0)
        axes[0].set_ylabel("ride (Wk and Wd) / cruising speed")
        axes[0].legend(loc="lower left")
    return figure
