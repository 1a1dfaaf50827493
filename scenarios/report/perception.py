"""Figure of the perception report: bias and standard deviation of the near edge over distance."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from foreride.scenarios.perception_benchmark.judge import EVALUATION_DISTANCE_M
from foreride.scenarios.report.figures.files import save
from foreride.scenarios.report.labels import plain
from foreride.scenarios.report.palette import CONTROLLER_COLOURS


def write_error_figure(path: Path, rows: Sequence[dict[str, Any]]) -> None:
    """Plot bias with one-sigma bars against true distance, one panel per row of the report."""
    figure = Figure(figsize=(4.6 * min(len(rows), 3), 3.4 * -(-len(rows) // 3)), layout="constrained")
    axes = figure.subplots(-(-len(rows) // 3), min(len(rows), 3), squeeze=False, sharex=True, sharey=True)
    for axis in axes.flat[len(rows) :]:
        axis.set_visible(False)
    for axis, row in zip(axes.flat, rows, strict=False):
        bins = row["by_distance"]
        centres_m = [0.5 * (b["from_m"] + b["to_m"]) for b in bins]
        axis.axhline(0.0, color="#999999", lw=0.8)
        axis.axvline(EVALUATION_DISTANCE_M, color="#b0413e", lw=0.8, ls="--")
        axis.errorbar(
            centres_m,
            [b["bias_m"] for b in bins],
            yerr=[b["sigma_m"] for b in bins],
            fmt="o-",
            ms=3,
            lw=1.2,
            capsize=2.5,
            color=CONTROLLER_COLOURS["mpc_preview"],
        )
        axis.set_title(plain(f"{row['name']} ({row['events']} events)"), fontsize=10)
        axis.set_ylim(-1.5, 1.5)
        axis.set_xlabel("distance of the front wheel (m)")
        axis.set_ylabel("believed - true near edge (m)")
    save(figure, path)
