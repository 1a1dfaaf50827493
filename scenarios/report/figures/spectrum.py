"""Figure of the power spectral density of the body acceleration, with the weighting Wk of ISO 2631-1."""

import math
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from foreride.comfort import frequency_weighting
from foreride.scenarios.report.figures.drive import add_legend
from foreride.scenarios.report.figures.ensemble import Array, band, ensembles, seeds_note
from foreride.scenarios.report.figures.files import WIDTH_IN, styled
from foreride.scenarios.report.labels import acceleration_label
from foreride.scenarios.report.spectra import density
from foreride.scenarios.simulation.simulate import Run

_DECADES = 1e-5


def spectrum_figure(runs: Sequence[Run]) -> Figure:
    """Figure of the runs of one scenario, all seeds, with the same car."""
    groups = ensembles(runs)
    car = runs[0].case.scenario.vehicle.parameters
    with styled():
        figure = Figure(figsize=(WIDTH_IN, 4.4), layout="constrained")
        axis = figure.subplots()
        greatest = 0.0
        for group in groups:
            frequency, densities = density(group.runs)
            values = band(densities)
            greatest = max(greatest, float(values.high.max()))
            group.line.draw(axis, frequency, values)
        axis.set(
            xscale="log", yscale="log", xlabel="frequency (Hz)", ylabel="power spectral density ((m/s²)²/Hz)"
        )
        if greatest > 0.0:
            axis.set_ylim(greatest * _DECADES, greatest * 2)
        axis.yaxis.set_major_formatter(
            lambda value, _: f"{value:.0e}".replace("e-0", "e-").replace("e+00", "")
        )
        axis.set_xlim(frequency[0], frequency[-1])
        axis.set_xticks([0.5, 1, 2, 5, 10, 20, 50], ["0.5", "1", "2", "5", "10", "20", "50"])
        axis.minorticks_off()
        _weighting(axis, frequency)
        title = f"{runs[0].case.scenario.title}: {acceleration_label(car)}"
        add_legend(figure, axis, title, seeds_note(groups))
    return figure


def _power(value: float) -> str:
    """Label of a power of ten, without Matplotlib's formulas, which are slow."""
    return f"1e{round(math.log10(value))}" if value > 0.0 else ""


def _weighting(axis: Axes, frequency: Array) -> None:
    """Shade the weighting, on an axis of its own."""
    right = axis.twinx()
    weights = frequency_weighting("Wk", frequency)
    right.fill_between(frequency, 0.0, weights, color="#000000", alpha=0.07, lw=0)
    right.plot(frequency, weights, color="#000000", alpha=0.35, lw=1.0)
    right.set_ylabel("|Wk| of ISO 2631-1 (shaded)")
    right.set_ylim(0, 2.2)
    right.set_yticks(np.arange(0.0, 1.01, 0.5))
    right.grid(False)
