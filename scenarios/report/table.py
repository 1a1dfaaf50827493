"""The comparison as a terminal table."""

from collections.abc import Sequence
from itertools import groupby
from statistics import fmean

from rich import box
from rich.table import Table

from scenarios.closed_loop import Run

Column = tuple[str, str, str]

_COLUMNS: tuple[Column, ...] = (
    ("J / passive", "objective", ".3f"),
    ("Wk RMS\nm/s²", "wk_rms", ".3f"),
    ("VDV\nm/s^1.75", "vdv", ".2f"),
    ("peak acc.\nm/s²", "peak_acc", ".2f"),
    ("rattle\npeak mm", "rattle_peak", ".0f"),
    ("stops\nms", "stop_time", ".0f"),
    ("tyre load\nRMS", "tyre_load_rms", ".3f"),
    ("lift\nms", "lift_time", ".0f"),
)
_ESSENTIAL = ("objective", "wk_rms", "vdv", "tyre_load_rms", "lift_time")
_NARROW = 136
_FACTOR = {"rattle_peak": 1e3, "stop_time": 1e3, "lift_time": 1e3}


def comparison(runs: Sequence[Run], title: str = "", width: int = _NARROW) -> Table:
    """Mean over seeds for each scenario, controller and perception; J relative to passive where it ran.

    `width` is that of the terminal in characters; a narrow one gets the essential columns only.
    """
    columns = [column for column in _COLUMNS if width >= _NARROW or column[1] in _ESSENTIAL]
    table = Table(title=title or None, box=box.SIMPLE_HEAD, title_justify="left")
    for name in ("scenario", "controller", "preview"):
        table.add_column(name, no_wrap=True)
    for name, _, _ in columns:
        table.add_column(name, justify="right", no_wrap=True)
    table.add_column("fall-\nbacks", justify="right")
    for scenario, group in groupby(runs, key=lambda run: run.case.scenario.name):
        _add_scenario(table, scenario, list(group), columns)
    return table


def _add_scenario(table: Table, scenario: str, runs: Sequence[Run], columns: Sequence[Column]) -> None:
    passive = {run.case.seed: run.metrics["objective"] for run in runs if run.case.controller == "passive"}
    variants = dict.fromkeys((run.case.controller, run.case.perception) for run in runs)
    for index, variant in enumerate(variants):
        members = [run for run in runs if (run.case.controller, run.case.perception) == variant]
        cells = [_cell(members, metric, style, passive) for _, metric, style in columns]
        fallbacks = sum(int(run.solver.get("fallbacks", 0)) for run in members)
        first = scenario if index == 0 else ""
        last = index == len(variants) - 1
        controller, perception = variant
        shown = controller.rpartition(":")[2]
        table.add_row(
            first, shown, perception, *cells, str(fallbacks) if fallbacks else "-", end_section=last
        )


def _cell(runs: Sequence[Run], metric: str, style: str, passive: dict[int, float]) -> str:
    values = [run.metrics[metric] * _FACTOR.get(metric, 1.0) for run in runs]
    if metric == "objective":
        if any(run.case.seed not in passive for run in runs):
            return f"{fmean(values):.3f} abs"
        values = [run.metrics[metric] / passive[run.case.seed] for run in runs]
    return format(fmean(values), style)
