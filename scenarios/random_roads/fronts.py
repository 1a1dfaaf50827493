"""Pareto fronts of comfort, tyre load and suspension travel: what a controller can trade for what.

Each controller is driven with several values of the setting that trades one for the other. All values are
relative to the passive car. The hypervolume of a front is the share that it dominates of the box between zero
and `REFERENCE` (E. Zitzler and L. Thiele, IEEE Trans. Evolutionary Computation 3(4), 1999).
"""

from collections.abc import Sequence
from itertools import product

import numpy as np
from numpy.typing import NDArray

from foreride.scenarios.random_roads.drives import Line, lines
from foreride.scenarios.random_roads.results import Results

Array = NDArray[np.float64]
REFERENCE = 1.25
"""Far corner of the box: controlled cars use up to about so much more travel than the passive one."""
METRICS = ("wk_rms", "tyre_load_rms", "rattle_rms")
"""Comfort, load and travel: the axes of a front."""

_RHO = "mpc.rho", (0.3, 1.0, 3.0, 10.0, 30.0)
_TRADES: dict[str, tuple[str, tuple[float, ...]]] = {
    "skyhook": ("skyhook.ground_ns_m", (0.0, 300.0, 800.0, 1500.0, 3000.0)),
    "hybrid": ("hybrid.alpha", (0.9, 0.7, 0.5, 0.3, 0.1)),
    "lqr_clipped": ("lqr_clipped.rho", (0.3, 1.0, 3.0, 10.0, 30.0)),
    "mpc_reactive": _RHO,
    "mpc_wheelbase": _RHO,
    "mpc_preview": _RHO,
}
"""Setting of each controller that trades comfort for load, and its values; others have a single point."""

_LIMITS = "control.settings.mpc.limits"
_LIMITED = tuple(
    f"{_LIMITS}={{unloading: {unloading:g}, travel: {travel:g}}}"
    for unloading, travel in ((0.8, 0.9), (0.5, 0.8), (0.3, 0.7), (0.15, 0.6))
)
"""Soft limits of tyre load and travel in place of another weight, from wide to narrow."""


def front_lines(controllers: Sequence[str], perceptions: Sequence[str], limits: bool = False) -> list[Line]:
    """A line for each controller and value of its setting; the condition is the override.

    limits: with lines of soft limits for the predictive controllers.
    """
    return [
        line._replace(condition=condition)
        for line in lines(controllers, perceptions)
        for condition in [*_overrides(line.controller), *(_LIMITED if limits and _is_mpc(line) else ())]
    ]


def _is_mpc(line: Line) -> bool:
    return _TRADES.get(line.controller) == _RHO


def _front_of(line: Line) -> str:
    """Name of the front that a line is a point of."""
    return f"{line.name} (limits)" if line.condition.startswith(_LIMITS) else line.name


def _overrides(controller: str) -> list[str]:
    if controller not in _TRADES:
        return [""]
    setting, values = _TRADES[controller]
    return [f"control.settings.{setting}={value:g}" for value in values]


def points(results: Results) -> dict[str, tuple[list[str], Array]]:
    """Conditions and points (n, metrics) of each controller: means over events and seeds."""
    passive = results.of_line[Line("passive", "none")]
    found: dict[str, tuple[list[str], list[list[float]]]] = {}
    for line, metrics in results.of_line.items():
        conditions, rows = found.setdefault(_front_of(line), ([], []))
        conditions.append(line.condition)
        rows.append([float(np.mean(metrics[name] / passive[name])) for name in METRICS])
    return {name: (conditions, np.array(rows)) for name, (conditions, rows) in found.items()}


def efficient(values: Array) -> NDArray[np.bool_]:
    """Mask (n,) of the points that no other one dominates; smaller is better."""
    no_worse = (values[:, None] <= values).min(axis=2)
    better = (values[:, None] < values).max(axis=2)
    dominated: NDArray[np.bool_] = np.logical_and(no_worse, better).max(axis=0)
    return ~dominated


def hypervolume(values: Array) -> float:
    """Share of the box between zero and `REFERENCE` that points (n, d) dominate.

    Exact: the points' coordinates cut the box into cells that are dominated as a whole or not at all.
    """
    inside = np.clip(values / REFERENCE, 0.0, 1.0)
    edges = [np.unique(np.append(column, 1.0)) for column in inside.T]
    corners = np.array(list(product(*(edge[:-1] for edge in edges)))).reshape(-1, values.shape[1])
    sizes = np.array(list(product(*(np.diff(edge) for edge in edges)))).reshape(-1, values.shape[1])
    dominated: NDArray[np.bool_] = (inside[None] <= corners[:, None]).min(axis=2).max(axis=1)
    return float(sizes.prod(axis=1)[dominated].sum())
