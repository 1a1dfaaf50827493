"""Argument vectors as inputs: the whole command line up to the first drive, image or optimisation."""

import io
import json
import os
from collections.abc import Callable
from contextlib import chdir, redirect_stderr, redirect_stdout
from functools import cache
from pathlib import Path
from typing import Any, NoReturn

from foreride.files.errors import InputError
from tests.fuzz.reader import Reader
from tests.fuzz.readers import READERS

SHORT = """
title: A short drive
speed_kmh: 60
road: {length_m: 12, features: [{kind: half_sine_bump, start_m: 6, height_m: 0.05, length_m: 0.5}]}
vehicle: {model: quarter}
"""

VECTORS: dict[str, list[str]] = {
    "run": ["run", "short.yaml", "--controllers", "passive,skyhook", "--perception", "none,oracle",
            "--seeds", "0,1", "--jobs", "1", "--vehicle", "half", "--observer", "truth", "--set",
            "speed_kmh=50", "--set", "camera.latency_s=0.1", "--out", "out", "--json", "out.json",
            "--baseline", "passive"],
    "compare": ["compare", "short.yaml", "bump_8x40_30", "--controllers", "passive,mpc_preview", "--seeds",
                "0", "--settings", "settings.yaml", "--bound", "--baseline", "passive@none", "--parquet",
                "a.parquet", "--markdown", "a.md", "--latex", "a.tex", "--frames", "--out", "out"],
    "sweep": ["sweep", "study.yaml", "--out", "out", "--jobs", "1", "--retry-failed", "--json", "a.json"],
    "regress": ["regress", "short.yaml", "--accept", "--baseline", "baseline.json", "--controllers",
                "passive", "--json", "a.json"],
    "bound": ["bound", "short.yaml", "--actuator", "slow_active", "--set", "tyre_load_weight=2.0"],
    "tune": ["tune", "short.yaml", "--controllers", "skyhook", "--evaluations", "8", "--seed", "1", "--out",
             "tuned.yaml"],
    "perception": ["perception", "short.yaml", "--courses", "bumps,potholes", "--looks", "day", "--braking",
                   "1.0", "--grade", "0.02", "--events", "2", "--perception", "boxes", "--json", "a.json"],
    "render": ["render", "short.yaml", "--every", "2.0", "--detect", "--out", "images", "--json", "a.json"],
    "report": ["report", "run", "--out", "report.html", "--no-render", "--budget", "budget.json"],
    "log": ["log", "run", "--out", "run.mcap", "--mf4", "run.mf4"],
    "replay": ["replay", "drive.csv", "--images", "pictures", "--scenario", "short.yaml", "--signal",
               "pitch_rate=-gyro [deg/s]", "--signal", "roll_rate=0", "--set", "camera.height_m=1.2", "--out",
               "out", "--json", "a.json"],
    "road": ["road", "road.csv", "--json", "a.json"],
    "calibrate": ["calibrate", "a.png", "b.png", "--squares", "9x6", "--square_m", "0.03", "--ground",
                  "a.png", "--out", "camera.yaml"],
    "convert": ["detector", "convert", "set", "coco.json", "--class", "0=speed_bump", "--skip-bad"],
    "eval": ["detector", "eval", "--data", "set", "--confidence", "0.5", "--degrade", "rain", "--strength",
             "0.5", "--threads", "1", "--ignore-masks", "--skip-bad", "--json", "a.json"],
}  # fmt: skip


class _Reached(BaseException):
    """A command has taken its input and begins to work."""


def _reached(*given: Any, **named: Any) -> NoReturn:
    raise _Reached


@cache
def _without_work() -> None:
    """Commands end where they would drive, draw, search or start processes: their input has been taken."""
    from concurrent.futures import ProcessPoolExecutor
    from multiprocessing.pool import Pool

    from foreride.road.render.scene import Scene
    from foreride.scenarios.bound import optimum_cache
    from foreride.scenarios.commands.drive import sweep
    from foreride.scenarios.simulation.multirate_loop import MultirateLoop

    for owner, name in (
        (MultirateLoop, "drive"),
        (Scene, "__init__"),
        (Pool, "__init__"),
        (ProcessPoolExecutor, "__init__"),
        (optimum_cache, "optimise"),
        (sweep, "cluster"),
    ):
        setattr(owner, name, _reached)


def _placed(vector: list[str]) -> Callable[[Path], Path]:
    def place(folder: Path) -> Path:
        (folder / "short.yaml").write_text(SHORT)
        for name, file in (
            ("settings", "settings.yaml"),
            ("study", "study.yaml"),
            ("baseline", "baseline.json"),
            ("budget", "budget.json"),
            ("road.csv", "road.csv"),
        ):
            os.replace(READERS[name].place(folder), folder / file)
        READERS["image.png"].place(folder).rename(folder / "a.png")
        path = folder / "arguments.json"
        path.write_text(json.dumps(vector))
        return path

    return place


def _read(path: Path) -> None:
    """Run the command that the file lists; its refusal as InputError."""
    from foreride.scenarios.cli import main

    _without_work()
    told = io.StringIO()
    try:
        with chdir(path.parent), redirect_stdout(io.StringIO()), redirect_stderr(told):
            status: Any = main(_vector(path))
    except _Reached:
        return
    except SystemExit as error:
        status = error.code
    lines = told.getvalue().splitlines()
    if status == 2:
        usage = bool(lines) and lines[0].startswith("usage:")
        raise InputError(lines[-1] if usage else told.getvalue().removesuffix("\n"))
    if status not in (0, 1):
        raise AssertionError(f"exit code {status!r}: {told.getvalue()[:400]}")


def _vector(path: Path) -> list[str]:
    """What a shell could pass: no NUL, and no surrogates but those that stand for bytes."""
    try:
        values = json.loads(path.read_bytes().decode("utf-8", "surrogateescape"))
    except (ValueError, RecursionError):
        return []
    texts = [str(value) for value in values] if isinstance(values, list) else []
    return [os.fsdecode(text.encode("utf-8", "replace")) for text in texts if "\0" not in text]


ARGUMENTS = {f"arguments of {name}": Reader(_placed(vector), _read) for name, vector in VECTORS.items()}
