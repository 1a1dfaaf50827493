"""Overview of a comparison: body acceleration on each drive, and the objective of each controller."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from foreride.scenarios.comparison.statistics import Row, Variant, summarise
from foreride.scenarios.report.figures.drive import ROAD_COLOUR
from foreride.scenarios.report.figures.ensemble import Array, Band, Line, ensembles, seeds_note
from foreride.scenarios.report.figures.files import WIDTH_IN, styled
from foreride.scenarios.report.labels import acceleration_label, plain, variant_label
from foreride.scenarios.report.palette import colours_of
from foreride.scenarios.report.window import event_window
from foreride.scenarios.simulation.simulate import Run

MOST_TRACED = 8
"""Greatest number of drives with signals; beyond it the overview shows the objective alone."""
_STRIDE = 4

Drive = tuple[str, str]
"""Name of a scenario and of a vehicle."""


@dataclass(frozen=True)
class Excerpt:
    """Road under the front wheel (mm) and body acceleration (m/s²) around the event of a drive."""

    title: str
    acceleration: str
    time_s: Array
    road_mm: Array
    lines: tuple[tuple[Line, Band], ...]
    note: str


def excerpt(runs: Sequence[Run]) -> Excerpt:
    """Excerpt of the runs of one drive; it keeps no other signals of theirs."""
    scenario, groups = runs[0].case.scenario, ensembles(runs)
    part = slice(*event_window(runs[0], 0.5, 1.2), _STRIDE)
    return Excerpt(
        scenario.title,
        acceleration_label(scenario.vehicle.parameters),
        runs[0].signals["time_s"][part].copy(),
        runs[0].signals["road_height_0"][part] * 1e3,
        tuple((group.line, group.signal("seat_acc_0", part)) for group in groups),
        seeds_note(groups),
    )


def overview_figure(rows: Sequence[Row], excerpts: Mapping[Drive, Excerpt], baseline: str | None) -> Figure:
    """Figure of a comparison; `baseline` as in its table, `excerpts` of the drives to be traced."""
    variants = summarise(rows, baseline)
    drives = {key: list(group) for key, group in groupby(variants, key=lambda v: (v.scenario, v.vehicle))}
    colours = colours_of(variant.controller for variant in variants)
    traced = len(drives) <= MOST_TRACED and drives.keys() <= excerpts.keys()
    greatest = max(_effect(variant)[2] for variant in variants)
    with styled():
        heights = [0.8 + 0.4 * len(members) for members in drives.values()]
        heights = [max(height, 2.2) for height in heights] if traced else heights
        figure = Figure(figsize=(WIDTH_IN, sum(heights) + 0.6), layout="constrained")
        parts = figure.subfigures(len(drives), 1, squeeze=False, height_ratios=heights)[:, 0]
        for part, (drive, members) in zip(parts, drives.items(), strict=True):
            part.suptitle(plain(excerpts[drive].title if drive in excerpts else drive[0]), fontsize=12)
            if traced:
                left, right = part.subplots(1, 2, width_ratios=(1.15, 1))
                _trace(left, excerpts[drive])
            else:
                right = part.subplots()
            _bars(right, members, colours, greatest, baseline)
    return figure


def _trace(axis: Axes, shown: Excerpt) -> None:
    for line, values in shown.lines:
        line.draw(axis, shown.time_s, values)
    low, high = axis.get_ylim()
    axis.set_ylim(low - 0.3 * (high - low), high)
    road = axis.twinx()
    reach = max(float(abs(shown.road_mm).max()), 5.0)
    road.fill_between(shown.time_s, 0.0, shown.road_mm, color=ROAD_COLOUR, alpha=0.45, lw=0)
    road.axhline(0.0, color=ROAD_COLOUR, lw=0.8)
    road.set_ylim(-1.2 * reach, 9.0 * reach)
    road.axis("off")
    axis.set_xlim(shown.time_s[0], shown.time_s[-1])
    axis.yaxis.set_major_locator(MaxNLocator(4, integer=True))
    axis.xaxis.set_major_locator(MaxNLocator(5, prune="both"))  # none at the edge to the bars
    axis.set_xlabel("time (s)" + (f"; {shown.note}" if shown.note else ""), fontsize=9)
    axis.set_title(f"{shown.acceleration} (m/s²)", fontsize=10, loc="left")


def _bars(
    axis: Axes,
    variants: Sequence[Variant],
    colours: Mapping[str, str],
    greatest: float,
    baseline: str | None,
) -> None:
    for index, variant in enumerate(variants):
        mean, low, high = _effect(variant)
        axis.barh(index, mean, height=0.42, color=colours[variant.controller])
        if high > low:
            axis.plot([low, high], [index, index], color="#000000", lw=1.2, marker="|", ms=6)
        name = plain(variant_label(variant.controller, variant.perception))
        axis.text(0.0, index - 0.25, f"{name}  {mean:.3f}", va="bottom", fontsize=10.5)
    axis.set_ylim(len(variants) - 0.6, -0.85)
    axis.set_yticks([])
    axis.set_xlim(0, 1.05 * greatest)
    relative = baseline and all("objective" in variant.ratio for variant in variants)
    objective = f"J relative to {plain(baseline or '')}" if relative else "J ((m/s²)²)"
    spread = any(high > low for _, low, high in map(_effect, variants))
    axis.set_title(objective + (", 95 % interval" if spread else ""), fontsize=10, loc="left")
    axis.spines["left"].set_visible(False)


def _effect(variant: Variant) -> tuple[float, float, float]:
    """J, relative to the baseline if there is one: mean and interval (which may be empty)."""
    value = variant.ratio.get("objective", variant.metrics["objective"])
    low, high = (value.mean if limit is None else limit for limit in (value.low, value.high))
    return value.mean, low, high
