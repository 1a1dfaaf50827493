"""SIGKILL in every command that writes, at system calls and moments.

`python -m tests.robustness.kill_points`: after each kill all that the command writes must be the old or the
whole new one, what is left must not be read as a run, and the same command must end well and clean up.
"""

import argparse
import importlib
import os
import random
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from foreride.files.errors import InputError
from tests.robustness.child import counted, killed_at, run
from tests.robustness.state import State, problems, scratch_in, state_of
from tests.robustness.writers import SLOW, WORK, WRITERS, Writer, fresh, place_inputs

QUICK = ("compare", "short.yaml", "--controllers", "passive", "--no-figures", "--out", "compared")


@dataclass(frozen=True)
class Stage:
    """A command with its states: before, and after it has run undisturbed.

    calls: how many system calls concern its folder. seconds: how long it takes.
    """

    writer: Writer
    place: Path
    start: Path
    before: State
    after: State
    calls: int
    seconds: float


def stage(writer: Writer, place: Path, over: bool) -> Stage:
    """Run the command once; `over` puts its targets there first, from the old inputs."""
    place, start, work = place.resolve(), place.resolve() / "start", place.resolve() / WORK
    start.mkdir(exist_ok=True)
    if over:
        _well(writer, "old", start)
    fresh(work, start)
    began = time.monotonic()
    _well(writer, "new", work, counted(work, place / "count"))
    seconds, calls = time.monotonic() - began, int((place / "count").read_text())
    return Stage(writer, place, start, state_of(start), state_of(work), calls, seconds)


def _well(writer: Writer, version: str, work: Path, before: Callable[[], None] = lambda: None) -> None:
    ended = run(writer, version, work, before)
    if ended.status:
        raise RuntimeError(f"{writer.arguments}: exit code {ended.status}: {' '.join(ended.told)[-500:]}")


def kill(staged: Stage, before: Callable[[], None], after_s: float | None) -> list[str]:
    """Kill the command once; what was wrong then and after the next run."""
    work = staged.place / WORK
    fresh(work, staged.start)
    run(staged.writer, "new", work, before, after_s)
    told = problems(work, staged.before, staged.after) + _misread(work)
    done = staged.writer.once and state_of(work) != {}
    ended = run(staged.writer, "new", work)
    if ended.status != (2 if done else 0):
        told.append(f"next run: exit code {ended.status}: {' '.join(ended.told)[-300:]}")
    told += [f"next run: {one}" for one in problems(work, staged.before, staged.after)]
    told += [f"next run: {name} is still there" for name in scratch_in(work)]
    missing = staged.after.keys() - state_of(work).keys()
    return told + [f"next run: {name} is missing" for name in missing if "tfevents" not in name]


def _misread(work: Path) -> list[str]:
    """Scratch that a report takes for runs."""
    from foreride.scenarios.report.gather import collect_input

    told = []
    for folder in (work, *(path for path in work.iterdir() if path.is_dir())):
        try:
            found = collect_input(folder)
        except InputError:
            continue
        except Exception as error:
            told.append(f"report of {folder.name}: {type(error).__name__}: {error}"[:200])
            continue
        names = [run.case.scenario.name for run in found.runs]
        told += [f"report of {folder.name}: read {name}" for name in names if name != "short"]
    return told


def points(staged: Stage, count: int, seed: int) -> Iterator[tuple[str, list[str]]]:
    """So many kills, two thirds of them at calls spread over all, the others at random moments."""
    rng, calls = random.Random(seed), min(staged.calls, max(1, 2 * count // 3))
    for number in sorted(rng.sample(range(1, staged.calls + 1), calls)):
        yield f"call {number} of {staged.calls}", kill(staged, killed_at(number, staged.place / WORK), None)
    for _ in range(count - calls):
        moment = rng.uniform(0, staged.seconds)
        yield f"after {1000 * moment:.0f} ms", kill(staged, lambda: None, moment)


def main() -> int:
    """Kill, check, print figures; 1 where anything was found."""
    parser = argparse.ArgumentParser(prog="python -m tests.robustness.kill_points", description=__doc__)
    parser.add_argument("--points", type=int, default=600, help="of all commands together (default 600)")
    parser.add_argument("--commands", metavar="A,B,...", help=f"default: all of {', '.join(WRITERS)}")
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()
    names = arguments.commands.split(",") if arguments.commands else list(WRITERS)
    weights = {name: 1 if name in SLOW else 5 for name in names}
    total = found = 0
    with tempfile.TemporaryDirectory(prefix="foreride-kill-") as folder:
        os.environ["FORERIDE_CACHE"] = str(Path(folder) / WORK / "cache")
        place = Path(folder)
        warm(place, names)
        for name in names:
            share = max(2, round(arguments.points * weights[name] / sum(weights.values())))
            for over in (False,) if WRITERS[name].once else (False, True):
                done, wrong = _campaign(name, place, over, share // 2, arguments.seed)
                total, found = total + done, found + wrong
    print(f"{total} kill points, {found} of them with findings")
    return int(found > 0)


def warm(place: Path, names: Sequence[str]) -> None:
    """Make the inputs of the commands, and import what they need before anything is forked.

    Not torch, whose threads do not survive a fork.
    """
    trains = any("train" in name or "export" in name for name in names)
    for module in ("foreride.scenarios.cli", "foreride.scenarios.report.html", "pyarrow.parquet"):
        importlib.import_module(module)
    for version, speed in (("old", 50), ("new", 60)):
        place_inputs(place / version, version, speed)
    for version in ("old", "new"):
        folder = place / version
        _well(
            Writer(QUICK),
            version,
            folder,
        )
        if not trains:
            continue
        _well(Writer(("detector", "train", "--data", "split", "--out", "t", "--stages", "64x64:1", "--model",
                      "yolo11n", "--batch", "2", "--device", "cpu")), version, folder)  # fmt: skip
        (folder / "t" / "weights.pt").rename(folder / "weights.pt")


def _campaign(name: str, place: Path, over: bool, count: int, seed: int) -> tuple[int, int]:
    for inner in ("start", WORK):
        fresh(place / inner, _empty(place))
    staged = stage(WRITERS[name], place, over)
    wrong = 0
    for where, told in points(staged, count, seed):
        wrong += bool(told)
        for line in told:
            print(f"{name}{' over old' if over else ''}, killed {where}: {line}", flush=True)
    state = "over an old result" if over else "into an empty folder"
    print(f"{name} {state}: {count} kill points, {staged.calls} calls, {wrong} with findings", flush=True)
    return count, wrong


def _empty(place: Path) -> Path:
    (place / "empty").mkdir(exist_ok=True)
    return place / "empty"


if __name__ == "__main__":
    sys.exit(main())
