"""Figure of one drive over time: road, body acceleration, damping, tyre load."""

from collections.abc import Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from foreride.scenarios.report.figures.ensemble import Ensemble, ensembles, seeds_note
from foreride.scenarios.report.figures.files import WIDTH_IN, styled
from foreride.scenarios.report.labels import acceleration_label, plain, wheel_label
from foreride.scenarios.report.window import event_window
from foreride.scenarios.simulation.simulate import Run

ROAD_COLOUR = "#555a60"


def drive_figure(runs: Sequence[Run]) -> Figure:
    """Figure of the runs of one scenario, all seeds, with the same car."""
    groups = ensembles(runs)
    with styled():
        figure = Figure(figsize=(WIDTH_IN, 7.6), layout="constrained")
        axes = figure.subplots(4, 1, sharex=True, height_ratios=(1, 2.2, 1.8, 1.6))
        _panels(list(axes), groups)
        add_legend(figure, axes[1], runs[0].case.scenario.title, seeds_note(groups))
    return figure


def add_legend(figure: Figure, axis: Axes, title: str, note: str = "") -> None:
    """Legend of an axis above all axes, under the title of the figure; a note below them."""
    handles, labels = axis.get_legend_handles_labels()
    columns = 2 if len(labels) == 4 or max(map(len, labels)) > 24 else 3
    figure.legend(
        handles, labels, loc="outside upper center", ncols=columns, title=plain(title), title_fontsize=11,
        markerscale=4,
    )  # fmt: skip
    if note:
        figure.supxlabel(note, fontsize=8)


def _panels(axes: Sequence[Axes], groups: Sequence[Ensemble]) -> None:
    road, *signals = axes
    run = groups[0].runs[0]
    car = run.case.scenario.vehicle.parameters
    part = slice(*event_window(run))
    time = run.signals["time_s"][part]
    height = run.signals["road_height_0"][part] * 1e3
    road.plot(time, height, color=ROAD_COLOUR)
    road.set_ylabel("road under\n" + wheel_label(car, 0, "wheel") + "\n(mm)")
    if abs(height).max() < 1.0:
        road.set_ylim(-1, 1)
    panels = (
        ("seat_acc_0", 1.0, acceleration_label(car).replace(" at", "\nat") + "\n(m/s²)"),
        ("damping_0", 1e-3, wheel_label(car, 0, "damping") + "\n(kN·s/m)"),
        ("tyre_force_0", 1e-3, wheel_label(car, 0, "tyre load") + "\n(kN)"),
    )
    for axis, (name, factor, label) in zip(signals, panels, strict=True):
        for group in groups:
            group.line.draw(axis, time, group.signal(name, part, factor))
        axis.set_ylabel(label)
    axes[-1].set_xlabel("time (s)")
    axes[-1].set_xlim(time[0], time[-1])
    axes[0].figure.align_ylabels(axes)  # type: ignore[union-attr]
