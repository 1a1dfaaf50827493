"""Readers of runs, comparisons, baselines and sweeps, each with a small valid file."""

import json
import shutil
from collections.abc import Callable
from functools import cache
from pathlib import Path
from tempfile import mkdtemp

from tests.fuzz.reader import Reader, picture, text_file

BASELINE = {
    "schema": 1,
    "manifest": {"versions": {"foreride": "0.0.1"}},
    "tolerances": {"objective": 0.1},
    "cases": [
        {"scenario": "bump_8x40_30", "set": ["speed_kmh=20"], "controller": "passive", "perception": "none",
         "seed": 0, "metrics": {"objective": 1.0}}
    ],
}  # fmt: skip
EVENT = {
    "event": "bump",
    "reactive": 0.9,
    "whole": 0.5,
    "all_true": 0.4,
    "rest": 0.1,
    "kept": 0.8,
    "sources": [{"source": "pitch", "replaced_by": "truth", "cost": 0.1, "objective": 0.45}],
}
BUDGET = {"schema": 1, "vehicle": "half", "seeds": [0], "table": [EVENT]}


@cache
def _run_folder() -> Path:
    """The folder of a short drive that a camera with true boxes has seen, with its frames."""
    from foreride.scenarios.cases import Case
    from foreride.scenarios.definition.loading import load
    from foreride.scenarios.runs.write import row, to_json, write
    from foreride.scenarios.simulation.simulate import simulate

    short = ["road.length_m=8", "road.features.0.start_m=7", "vehicle.model=quarter", "speed_kmh=60"]
    run = simulate(Case(load("bump_8x40_30", short), "mpc_preview", "boxes", 0))
    folder = Path(mkdtemp(prefix="foreride-fuzz-"))
    write(run, folder / "run")
    (folder / "run" / "frames").mkdir()
    for look in run.looks:
        (folder / "run" / "frames" / f"{look.tick:07d}.jpg").write_bytes(picture(".jpg"))
    (folder / "comparison.json").write_text(to_json({"schema": 1, "planned": [], "rows": [row(run)]}))
    return folder


def _in_run(name: str) -> Callable[[Path], Path]:
    def place(folder: Path) -> Path:
        shutil.copytree(_run_folder() / "run", folder, dirs_exist_ok=True)
        return folder / name

    return place


def _comparison_file(folder: Path) -> Path:
    return Path(shutil.copy(_run_folder() / "comparison.json", folder / "comparison.json"))


def _frame_file(folder: Path) -> Path:
    return min((_in_run("frames")(folder)).iterdir())


def _run(path: Path) -> object:
    from foreride.files.writing.marker import seal
    from foreride.scenarios.runs.read import read
    from foreride.scenarios.runs.write import KIND

    folder = path.parent.parent if path.parent.name == "frames" else path.parent
    if path.is_file():
        seal(folder, KIND)  # what is wrong in it shall not be found by its checksum alone
    return read(folder)


def _baseline(path: Path) -> object:
    from foreride.scenarios.regression.baseline import read

    return read(path)


def _budget(path: Path) -> object:
    from foreride.scenarios.report.budget import error_budget_section

    return error_budget_section(path)


def _comparison(path: Path) -> object:
    from foreride.scenarios.report.gather import collect_input
    from foreride.scenarios.report.html import page

    return page(collect_input(path))


def _results_row(key: str) -> dict[str, object]:
    return {"key": key, "error": None, "scenario": "bump", "metrics.objective": 1.0}


def _part_file(folder: Path) -> Path:
    from foreride.scenarios.studies.results import Results

    results = Results(folder)
    results.add(_results_row("a"))
    results.flush()
    return (folder / "drives" / "part-00000.parquet").rename(folder / "part-00000.parquet")


def _results(path: Path) -> object:
    from foreride.files.writing.marker import seal
    from foreride.scenarios.studies.results import KIND, Results, load_results

    if path.is_file():
        seal(path.parent, KIND)
    return Results(path.parent).done, load_results(path.parent) if path.suffix == ".parquet" else None


RESULT_READERS: dict[str, Reader] = {
    "run's manifest": Reader(_in_run("manifest.json"), _run),
    "run's metrics": Reader(_in_run("metrics.json"), _run),
    "run's events": Reader(_in_run("events.jsonl"), _run),
    "run's signals": Reader(_in_run("signals.parquet"), _run),
    "run's previews": Reader(_in_run("previews.parquet"), _run),
    "run's frame": Reader(_frame_file, _run),
    "comparison": Reader(_comparison_file, _comparison),
    "baseline": Reader(text_file("baseline.json", json.dumps(BASELINE)), _baseline),
    "budget": Reader(text_file("budget.json", json.dumps(BUDGET)), _budget),
    "sweep's journal": Reader(text_file("journal.jsonl", json.dumps(_results_row("a")) + "\n"), _results),
    "sweep's part": Reader(_part_file, _results),
}
