"""`foreride report`: HTML report or video of a run or a comparison."""

import argparse
from collections.abc import Sequence
from dataclasses import replace
from itertools import groupby
from pathlib import Path

from foreride.files.command_line import notify
from foreride.files.errors import InputError
from foreride.files.writing.atomic import write_text
from foreride.files.writing.targets import check_files
from foreride.scenarios.commands.console import console, progress_bar
from foreride.scenarios.perceptions.registry import PERCEPTIONS
from foreride.scenarios.report.budget import error_budget_section
from foreride.scenarios.report.film.video import check_film, write_video
from foreride.scenarios.report.frames import has_frames, with_frames
from foreride.scenarios.report.gather import collect_input
from foreride.scenarios.report.html import first_seeds, page
from foreride.scenarios.simulation.simulate import Run

_RENDERED = "Rendered again from the run's own record."


def configure(command: argparse.ArgumentParser) -> None:
    """Add the options, and the function to execute."""
    told = "a run's folder, a folder of runs (compare --out), or the JSON file of a comparison"
    command.add_argument("source", type=Path, metavar="RUN|COMPARE", help=told)
    command.add_argument("--out", type=Path, metavar="FILE.html", help="default: report.html in that folder")
    command.add_argument(
        "--film", type=Path, metavar="FILE.webm", help="passive and preview side by side; or FILE.mp4"
    )
    none = "for runs without camera images show boxes only, instead of rendering the images again"
    command.add_argument("--no-render", action="store_true", help=none)
    told = "add where the gain of preview is lost, as `foreride table budget --json` wrote it"
    command.add_argument("--budget", type=Path, metavar="FILE", help=told)
    command.set_defaults(execute=execute, out_is_file=True)


def execute(arguments: argparse.Namespace) -> int:
    """Write the report, and the video if requested."""
    source: Path = arguments.source
    out = arguments.out or (source if source.is_dir() else source.parent) / "report.html"
    check_files(out, arguments.film, inputs=[source])
    if arguments.film:
        check_film(arguments.film)
    gathered = collect_input(source)
    budget = error_budget_section(arguments.budget) if arguments.budget else ""
    shown = first_seeds(gathered.runs)
    rendered = any(run.looks and not has_frames(run) for run in shown) and not arguments.no_render
    if rendered or arguments.film:
        filled = {id(run): run_with for run, run_with in zip(shown, _with_frames(shown), strict=True)}
        gathered = replace(gathered, runs=tuple(filled.get(id(run), run) for run in gathered.runs))
    write_text(out, page(gathered, _RENDERED if rendered else "", budget))
    console.print(f"report: {out} ({out.stat().st_size / 1e6:.1f} MB)")
    for message in gathered.missing:
        notify(f"partial report: {message}")
    if arguments.film:
        with console.status("writing the film"):
            write_video(arguments.film, _pairs(first_seeds(gathered.runs)))
        console.print(f"film: {arguments.film}")
    return 0


def _with_frames(runs: Sequence[Run]) -> list[Run]:
    with progress_bar() as progress:
        missing_images = sum(len(run.looks) for run in runs if not has_frames(run))
        bar = progress.add_task("camera images", total=missing_images)
        return [with_frames(run, lambda: progress.advance(bar)) for run in runs]


def _pairs(runs: Sequence[Run]) -> list[tuple[Run, Run]]:
    """(passive, best run with perception) of each drive."""
    pairs, ladder = [], PERCEPTIONS.names()
    for _, group in groupby(runs, key=lambda run: run.case.scenario.name):
        members = list(group)
        passive = next((run for run in members if run.case.controller == "passive"), None)
        seeing = [run for run in members if run.looks]
        if passive and seeing:
            pairs.append((passive, max(seeing, key=lambda run: ladder.index(run.case.perception))))
    if not pairs:
        raise InputError("--film needs a passive run and one with the perception boxes or camera")
    return pairs
