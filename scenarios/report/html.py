"""HTML report as one self-contained file."""

from collections.abc import Mapping, Sequence
from itertools import groupby
from pathlib import Path
from typing import Any

from foreride.scenarios.comparison.statistics import summarise, variants_of
from foreride.scenarios.perceptions.registry import PERCEPTIONS
from foreride.scenarios.report.gather import ReportInput
from foreride.scenarios.report.glossary import glossary_section
from foreride.scenarios.report.labels import drive_of, label_of
from foreride.scenarios.report.markup import embedded, text
from foreride.scenarios.report.palette import colours_of
from foreride.scenarios.report.replay import scene
from foreride.scenarios.report.sections import (
    budget_section,
    manifest_section,
    metrics_section,
    solver_section,
)
from foreride.scenarios.simulation.simulate import Run

_PAGE = Path(__file__).parent / "page"
_SCRIPTS = ("signals.js", "drawing.js", "charts.js", "main.js")
MAX_FRAMES = 300
"""Maximum number of frames in one file; with more exposures every second, third, ... is shown."""


def page(gathered: ReportInput, frames_from: str = "", budget: str = "") -> str:
    """Text of the report: `frames_from` notes the origin of the camera images, `budget` is a section."""
    runs = first_seeds(gathered.runs)
    baseline = "passive" if any(name == "passive" for name, _ in variants_of(gathered.rows)) else None
    variants = summarise(gathered.rows, baseline)
    colours = colours_of(str(row["controller"]) for row in gathered.rows)
    titles = {drive_of(run): run.case.scenario.title for run in gathered.runs}
    pieces: dict[str, str] = {
        "title": text(_title(gathered)),
        "subtitle": text(_subtitle(gathered)),
        "banner": _banner(gathered.missing),
        "replay_hidden": "" if runs else "hidden",
        "sections": metrics_section(variants, baseline, colours, titles)
        + glossary_section(variants, baseline, gathered.runs)
        + budget_section(variants)
        + budget,
        "tail": solver_section(gathered.runs) + manifest_section(gathered.runs) if runs else "",
        "style": _file("vendor/uPlot.min.css") + _file("style.css"),
        "data": embedded({"scenes": _scenes(runs, colours, frames_from)}),
        "uplot": _file("vendor/uPlot.iife.min.js"),
        "script": "".join(_file(name) for name in _SCRIPTS),
    }
    first, *rest = _file("page.html").split("{{")
    filled = (pieces[name] + after for name, after in (part.split("}}", 1) for part in rest))
    return first + "".join(filled)


def first_seeds(runs: Sequence[Run]) -> list[Run]:
    """Runs of the first seed of each scenario and vehicle, which the replay shows."""
    first_seed: dict[tuple[str, str], int] = {}
    return [run for run in runs if first_seed.setdefault(drive_of(run), run.case.seed) == run.case.seed]


def _scenes(runs: Sequence[Run], colours: Mapping[str, str], frames_from: str) -> list[dict[str, Any]]:
    images = sum(look.image is not None for run in runs for look in run.looks)
    frame_stride = max(1, -(-images // MAX_FRAMES))
    shown, ladder = [], PERCEPTIONS.names()
    for _, group in groupby(runs, key=drive_of):
        members = list(group)
        notes = {label_of(run): _frames_note(run, frames_from, frame_stride) for run in members}
        best = max(range(len(members)), key=lambda i: ladder.index(members[i].case.perception))
        shown.append(scene(members, colours, notes, frame_stride) | {"best": best})
    return shown


def _frames_note(run: Run, frames_from: str, frame_stride: int) -> str:
    if not run.looks:
        return "This run drove without a camera."
    if run.looks[0].image is None:
        return "Boxes and tracks only: this run kept no images."
    thinned = f" One exposure in {frame_stride} is shown." if frame_stride > 1 else ""
    return (
        f"{frames_from} Boxes with their scores; lines are tracks, dashed until confirmed.{thinned}".strip()
    )


def _title(gathered: ReportInput) -> str:
    names = list(dict.fromkeys(row["scenario"] for row in gathered.rows))
    if len(names) == 1:
        return gathered.runs[0].case.scenario.title if gathered.runs else str(names[0])
    return f"{len(names)} drives compared"


def _subtitle(gathered: ReportInput) -> str:
    controllers = list(dict.fromkeys(str(row["controller"]).rpartition(":")[2] for row in gathered.rows))
    seeds = len({row["seed"] for row in gathered.rows})
    vehicles = ", ".join(dict.fromkeys(str(row["vehicle"]) for row in gathered.rows))
    return f"{vehicles} car · {', '.join(controllers)} · {seeds} seed{'s' if seeds > 1 else ''}"


def _banner(missing: Sequence[str]) -> str:
    if not missing:
        return ""
    listed = "; ".join(missing[:3]) + (f"; and {len(missing) - 3} more" if len(missing) > 3 else "")
    return f'<p class="banner" role="alert"><b>Partial result.</b> {text(listed)}</p>'


def _file(name: str) -> str:
    return (_PAGE / name).read_text(encoding="utf-8")
