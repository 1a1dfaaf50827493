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
    colours = colours_of(_controller(name) for name in fronts)
    with styled():
        figure = Figure(figsize=(WIDTH_IN, 4.2), layout="constrained")
        axes = figure.subplots(1, 2, sharey=True)
        for axis, column, label in zip(axes, (1, 2), ("tyre load", "suspension travel"), strict=True):
            for name, (values, best, volume) in fronts.items():
                colour = colours[_controller(name)]
                _draw(
                    axis, values[:, [column, 0]], best, colour, f"{name} ({volume:.3f})", name.endswith(")")
                )
            axis.set_xlabel(f"{label} RMS / passive")
        axes[0].set_ylabel("Wk RMS / passive")
        handles, labels = axes[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=2, title="controller (hypervolume)")
    return figure


def _controller(name: str) -> str:
    """Controller of a front such as `mpc_preview@oracle (limits)`."""
    return name.partition(" ")[0].partition("@")[0]


def _draw(axis: Axes, values: Array, best: Mask, colour: str, label: str, dashed: bool) -> None:
    """Points of one front; the efficient ones are joined, dashed for soft limits."""
    joined, style = values[best], "--" if dashed else "-"
    joined = joined[np.argsort(joined[:, 0])]
    axis.plot(
        joined[:, 0], joined[:, 1], color=colour, linestyle=style, marker="o", markersize=4, label=label
    )
    others = values[~best]
    axis.scatter(others[:, 0], others[:, 1], color=colour, s=10, alpha=0.5)
