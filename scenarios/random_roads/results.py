"""Results over random roads: arrays by line, bootstrap intervals over events and seeds."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from foreride.scenarios.comparison.statistics import Interval
from foreride.scenarios.random_roads.drives import Line

Array = NDArray[np.float64]
RESAMPLES = 2000
FEW = 3
"""Fewer events than this give no interval."""


class Results(NamedTuple):
    """Metrics of all lines on the same events and seeds: line → metric → (events, seeds)."""

    events: tuple[int, ...]
    of_line: Mapping[Line, Mapping[str, Array]]

    def relative(self, line: Line, metric: str = "objective") -> Array:
        """The metric relative to the passive car of the same condition, (events, seeds)."""
        passive = self.of_line[Line("passive", "none", line.condition)]
        return self.of_line[line][metric] / passive[metric]


def collected(
    rows: Sequence[Mapping[str, Any]], lines: Sequence[Line], events: Sequence[int], seeds: Sequence[int]
) -> Results:
    """Arrange the rows of all lines, events and seeds."""
    found = {
        (Line(row["controller"], row["perception"], row["condition"]), row["event"], row["seed"]): row[
            "metrics"
        ]
        for row in rows
    }
    of_line = {}
    for line in lines:
        metrics = [[found[line, event, seed] for seed in seeds] for event in events]
        of_line[line] = {
            name: np.array([[one[name] for one in of_event] for of_event in metrics])
            for name in metrics[0][0]
        }
    return Results(tuple(events), of_line)


def interval(statistic: Callable[..., float], *values: Array) -> Interval:
    """The statistic of arrays (events, seeds), with a 95 % interval.

    Percentile bootstrap over events, and over the seeds within each; all arrays are resampled alike, as their
    drives share road and noise (A. C. Davison and D. V. Hinkley, Bootstrap Methods and their Application,
    1997, section 3.8).
    """
    events, seeds = values[0].shape
    estimate = statistic(*values)
    if events < FEW:
        return Interval(estimate)
    rng = np.random.default_rng(0)
    drawn = []
    for _ in range(RESAMPLES):
        at = rng.integers(events, size=(events, 1)), rng.integers(seeds, size=(events, seeds))
        drawn.append(statistic(*(value[at] for value in values)))
    low, high = np.percentile(drawn, [2.5, 97.5])
    return Interval(estimate, float(low), float(high))


def mean(values: Array) -> float:
    """Mean over events and seeds."""
    return float(values.mean())


def share_kept(rival: Array, achieved: Array, perfect: Array) -> float:
    """Share of the gain of perfect preview over a rival that is kept: 1 for all of it."""
    return float((rival.mean() - achieved.mean()) / (rival.mean() - perfect.mean()))


def worse(values: Array, rival: Array, by: float = 0.01) -> int:
    """Number of events in which the mean over seeds is worse than the rival's by more than this share."""
    return int(np.sum(values.mean(axis=1) > (1.0 + by) * rival.mean(axis=1)))
