"""Figures of runs, as PNG files."""

import io
from collections.abc import Sequence
from itertools import groupby
from pathlib import Path
from statistics import fmean

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from foreride.files.errors import printable
from foreride.files.writing.atomic import write_bytes
from foreride.scenarios.report.window import event_window
from foreride.scenarios.simulation.simulate import Run

COLOURS = {
    "passive": "#7b8188",
    "skyhook": "#c98a1b",
    "mpc_reactive": "#3f8f5f",
    "mpc_preview": "#1c6ebe",
}
_SPARE = ("#8d4fb0", "#b0413e", "#2a9d9d", "#5b5b9d")


def colour_of(controller: str, index: int) -> str:
    """Colour of a controller, the same in every figure."""
    return COLOURS.get(controller, _SPARE[index % len(_SPARE)])


def label_of(run: Run) -> str:
    """Legend label of a run."""
    name = printable(run.case.controller.rpartition(":")[2])
    return name if run.case.perception == "none" else f"{name} ({run.case.perception})"


def plain(text: str) -> str:
    """Text escaped for Matplotlib, which takes dollar signs for formulas."""
    return printable(text).replace("$", r"\$")


def write_overview(path: Path, runs: Sequence[Run]) -> None:
    """Figure with one column per event: road, body acceleration, damping, and J relative to passive."""
    groups = [list(group) for _, group in groupby(runs, key=lambda run: run.case.scenario.name)]
    figure = Figure(figsize=(5.2 * len(groups), 10.5), layout="constrained")
    axes = figure.subplots(4, len(groups), squeeze=False, height_ratios=(1, 2.2, 1.8, 1.6))
    for column, group in enumerate(groups):
        _event_column(list(axes[:3, column]), group)
        _bars(axes[3, column], group)
    save(figure, path)


def write_event_figure(path: Path, runs: Sequence[Run]) -> None:
    """Figure of road, body acceleration and damping for the runs of one scenario."""
    figure = Figure(figsize=(9, 7.5), layout="constrained")
    axes = figure.subplots(3, 1, height_ratios=(1, 2.2, 1.8))
    _event_column(list(axes), runs)
    axes[1].legend(fontsize=8, loc="upper right")
    save(figure, path)


def save(figure: Figure, path: Path) -> None:
    """Write a figure as PNG, atomically."""
    FigureCanvasAgg(figure)
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=110, metadata={"Software": None})
    write_bytes(path, buffer.getvalue())


def _event_column(axes: Sequence[Axes], runs: Sequence[Run]) -> None:
    road, acceleration, damping = axes
    start, end = event_window(runs[0])
    part = slice(start, end)
    time = runs[0].signals["time_s"][part]
    road.plot(time, runs[0].signals["road_height_0"][part] * 1e3, color="#555a60", lw=1.4)
    road.set_ylabel("road under\nfront wheel (mm)")
    road.set_title(plain(runs[0].case.scenario.title), fontsize=10)
    for index, run in enumerate(runs):
        colour, label = colour_of(run.case.controller, index), label_of(run)
        acceleration.plot(time, run.signals["seat_acc_0"][part], color=colour, lw=1.3, label=plain(label))
        damping.plot(time, run.signals["damping_0"][part] / 1e3, color=colour, lw=1.3)
    acceleration.set_ylabel("body acceleration\nat the front seat (m/s²)")
    damping.set_ylabel("front damping (kN·s/m)")
    damping.set_xlabel("time (s)")
    for axis in axes:
        axis.set_xlim(time[0], time[-1])
        axis.grid(alpha=0.25)


def _bars(axis: Axes, runs: Sequence[Run]) -> None:
    passive = fmean(run.metrics["objective"] for run in runs if run.case.controller == "passive")
    labels = list(dict.fromkeys(label_of(run) for run in runs))
    for index, label in enumerate(labels):
        members = [run for run in runs if label_of(run) == label]
        ratio = fmean(run.metrics["objective"] for run in members) / passive
        axis.barh(index, ratio, color=colour_of(members[0].case.controller, index))
        axis.text(ratio + 0.015, index, f"{ratio:.3f}", va="center", fontsize=9)
    axis.set_yticks(np.arange(len(labels)), [plain(label) for label in labels], fontsize=9)
    axis.invert_yaxis()
    axis.set_xlim(0, 1.2)
    axis.set_xlabel("objective J relative to passive (less is better)")
