"""Runs of one controller and perception over the seeds of a drive, with mean and range of their signals."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from foreride.scenarios.report.labels import label_of, plain, variant_label
from foreride.scenarios.report.palette import colours_of, dashes_of
from foreride.scenarios.simulation.simulate import Run

Array = NDArray[np.float64]
_MANY, _BAND_STRIDE = 1000, 4
"""Bands of many points are drawn from every fourth: no filled area is simplified by Matplotlib."""


class Band(NamedTuple):
    """Mean, least and greatest value over seeds."""

    mean: Array
    low: Array
    high: Array


@dataclass(frozen=True)
class Line:
    """Name and style of the line of a controller with a perception."""

    label: str
    colour: str
    dashes: tuple[int, ...]

    def draw(self, axis: Axes, x: Array, values: Band) -> None:
        """Plot the mean as a line, and the range over seeds as a band."""
        style = (0, self.dashes) if self.dashes else "-"
        axis.plot(x, values.mean, label=self.label, color=self.colour, linestyle=style)
        if (values.high > values.low).any():
            thinned = slice(None, None, _BAND_STRIDE if len(x) > _MANY else 1)
            low, high = values.low[thinned], values.high[thinned]
            axis.fill_between(x[thinned], low, high, color=self.colour, alpha=0.2, lw=0)


@dataclass(frozen=True)
class Ensemble:
    """Runs that differ in their seed alone, and their line."""

    runs: tuple[Run, ...]
    line: Line

    @property
    def name(self) -> str:
        """Name outside Matplotlib."""
        return label_of(self.runs[0])

    def signal(self, name: str, part: slice, factor: float = 1.0) -> Band:
        """Part of a signal, times a factor."""
        return band([run.signals[name][part] * factor for run in self.runs])


def band(rows: Sequence[Array]) -> Band:
    """Mean and range of the rows."""
    stacked = np.stack(rows)
    return Band(stacked.mean(axis=0), stacked.min(axis=0), stacked.max(axis=0))


def ensembles(runs: Sequence[Run]) -> list[Ensemble]:
    """Runs of one drive by controller and perception, in their order."""
    colours = colours_of(run.case.controller for run in runs)
    dashes = dashes_of(_variant(run) for run in runs)
    order = list(dict.fromkeys(_variant(run) for run in runs))
    ordered = sorted(runs, key=lambda run: order.index(_variant(run)))
    return [
        Ensemble(tuple(members), Line(plain(variant_label(*variant)), colours[variant[0]], dashes[variant]))
        for variant, members in groupby(ordered, key=_variant)
    ]


def seeds_note(groups: Sequence[Ensemble]) -> str:
    """What lines and bands show, if there are several seeds."""
    seeds = max(len(group.runs) for group in groups)
    return f"lines: mean of {seeds} seeds; bands: their range" if seeds > 1 else ""


def _variant(run: Run) -> tuple[str, str]:
    return run.case.controller, run.case.perception
