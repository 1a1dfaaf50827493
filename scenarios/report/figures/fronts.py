"""Figure of Pareto fronts: comfort against tyre load and against suspension travel."""

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from foreride.scenarios.report.figures.files import WIDTH_IN, styled
from foreride.scenarios.report.palette import colours_of

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


def fronts_figure(fronts: Mapping[str, tuple[Array, Mask, float]]) -> Figure:
    """Fronts by name of the controller: points (n, 3) of comfort, load and travel, those that no other one of
    the controller dominates, (n,), and the hypervolume.
    """
    colours = colours_of(name.partition("@")[0] for name in fronts)
    with styled():
        figure = Figure(figsize=(WIDTH_IN, 4.2), layout="constrained")
        axes = figure.subplots(1, 2, sharey=True)
        for axis, column, label in zip(axes, (1, 2), ("tyre load", "suspension travel"), strict=True):
            for name, (values, best, volume) in fronts.items():
                colour = colours[name.partition("@")[0]]
                _draw(axis, values[:, [column, 0]], best, colour, f"{name} ({volume:.3f})")
            axis.set_xlabel(f"{label} RMS / passive")
        axes[0].set_ylabel("Wk RMS / passive")
        handles, labels = axes[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=2, title="controller (hypervolume)")
    return figure


def _draw(axis: Axes, values: Array, best: Mask, colour: str, label: str) -> None:
    """Points of one controller; the efficient ones are joined."""
    joined = values[best]
    joined = joined[np.argsort(joined[:, 0])]
    axis.plot(joined[:, 0], joined[:, 1], color=colour, marker="o", markersize=4, label=label)
    others = values[~best]
    axis.scatter(others[:, 0], others[:, 1], color=colour, s=10, alpha=0.5)
