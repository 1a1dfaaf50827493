"""Force-velocity diagram of a damper: what it did in a drive, against the limits of its setting."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from foreride.scenarios.report.figures.drive import add_legend
from foreride.scenarios.report.figures.ensemble import Array, Ensemble, ensembles
from foreride.scenarios.report.figures.files import WIDTH_IN, styled
from foreride.scenarios.report.labels import wheel_label
from foreride.scenarios.report.window import event_window
from foreride.scenarios.simulation.simulate import Run
from foreride.vehicle.arithmetic import FLOATS
from foreride.vehicle.corner import Corner

_COLUMNS = 2
_STRIDE = 2
_SETTLING_S = 0.3
_STEP_S = 1e-3


def damper_figure(runs: Sequence[Run]) -> Figure:
    """Figure of the runs of one scenario, one panel for each controller and perception, all seeds."""
    groups = ensembles(runs)
    car = runs[0].case.scenario.vehicle.parameters
    rows = -(-len(groups) // _COLUMNS)
    columns = min(_COLUMNS, len(groups))
    with styled():
        figure = Figure(figsize=(WIDTH_IN, 0.9 + 2.5 * rows), layout="constrained")
        axes = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
        speeds = np.linspace(-1.03, 1.03, 61) * _greatest(groups, "rattle_velocity_0", 0.05)
        limits = [_steady(car.corners[0], setting, speeds) for setting in _settings(car.corners[0])]
        axes[0, 0].set_ylim(*np.array([-1.3, 1.3]) * _greatest(groups, "damper_force_0", 100.0) / 1e3)
        axes[0, 0].set_xlim(speeds[0], speeds[-1])
        for axis, group in zip(axes.flat, groups, strict=False):
            _panel(axis, group, speeds, limits)
        for axis in axes.flat[len(groups) :]:
            axis.set_visible(False)
        for column in range(columns):
            last = max(row for row in range(rows) if row * columns + column < len(groups))
            axes[last, column].tick_params(labelbottom=True)
        figure.supxlabel("velocity of the damper (m/s), rebound positive", fontsize=9)
        figure.supylabel("force (kN), rebound positive", fontsize=9)
        title = f"{runs[0].case.scenario.title}: {wheel_label(car, 0, 'damper')}"
        add_legend(figure, axes[0, 0], title)
    return figure


def _panel(axis: Axes, group: Ensemble, speeds: Array, limits: Sequence[Array]) -> None:
    softest, passive, firmest = (force / 1e3 for force in limits)
    axis.fill_between(
        speeds, softest, firmest, color="#000000", alpha=0.08, lw=0, label="range of the damper"
    )
    axis.plot(speeds, passive, color="#000000", alpha=0.5, lw=1.0, ls="--", label="passive setting")
    for number, run in enumerate(group.runs):
        part = slice(*event_window(run), _STRIDE)
        told = "every 2 ms of the drive" if number == 0 else None
        axis.plot(
            run.signals["rattle_velocity_0"][part], -run.signals["damper_force_0"][part] / 1e3,
            ".", ms=2.2, mew=0, color=group.line.colour, label=told, rasterized=True,
        )  # fmt: skip
    axis.set_title(group.line.label, color=group.line.colour)
    axis.axhline(0.0, color="#000000", lw=0.6, alpha=0.4)
    axis.axvline(0.0, color="#000000", lw=0.6, alpha=0.4)


def _greatest(groups: Sequence[Ensemble], signal: str, least: float) -> float:
    """Greatest magnitude of a signal in all runs, but at least `least`."""
    runs = [run for group in groups for run in group.runs]
    return max(least, *(float(np.abs(run.signals[signal][slice(*event_window(run))]).max()) for run in runs))


def _settings(corner: Corner) -> tuple[float, float, float]:
    return corner.damping_min_ns_m, corner.damping_passive_ns_m, corner.damping_max_ns_m


def _steady(corner: Corner, setting: float, speeds: Array) -> Array:
    """Force against the motion at constant speeds, N, after internal states have settled."""
    damper, normalised = corner.damper, float(corner.normalised_setting(setting))
    forces = []
    for speed in speeds.tolist():
        states = [0.0] * damper.internal_states
        for _ in range(round(_SETTLING_S / _STEP_S) if states else 0):
            states = damper.advance(normalised, 0.0, speed, states, _STEP_S)
        forces.append(-float(damper.force(setting, normalised, 0.0, speed, states, FLOATS)))
    return np.array(forces)
