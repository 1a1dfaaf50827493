"""Mutation score of packages: `python -m benchmarks.mutation --mutants 300 --seed 0 --json FILE`.

All mutants are judged by the nearest tests of their module, the survivors by those of its room, and with
`--until suite` by those elsewhere that reach the module and by those that drive: a lower bound of what the
whole suite notices. Tests that take longer than the limit count as not noticing. Mutants that are provably
the same code are counted apart (`equivalent.yaml`). A result is written per mutant and stage; an interrupted
run goes on from its file.
"""

import argparse
import json
import os
import tempfile
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.command import command
from benchmarks.mutation.choice import Mutant, drawn, files_elsewhere, files_judging
from benchmarks.mutation.equivalent import reason
from benchmarks.mutation.judge import copied, preload, verdict
from benchmarks.mutation.machine_code import code_aside, is_compiled
from benchmarks.mutation.operators import mutated
from foreride.files.errors import InputError

ROOT = Path(__file__).parents[2]
PACKAGES = ("controller", "vehicle", "preview", "comfort")
CHECK_LIMIT_S = 3600.0
STAGES = ("nearest", "room", "suite")
"""Tests that judge: the module's own, those of its room, and those elsewhere that reach it or drive."""


def judged(folder: Path, mutant: Mutant, limit_s: float, stage: str = "nearest") -> dict[str, Any]:
    """Result of one mutant by the tests of a stage; the copy is as before afterwards."""
    path = folder / mutant.file
    original, status = path.read_text(), path.stat()
    text, line, words = mutated(original, mutant.number)
    row = {"file": mutant.file, "number": mutant.number, "line": line, "change": words, "by": stage}
    if reason(folder, row) is not None:
        return row | {"result": "equivalent"}
    with code_aside(folder, mutant.file):
        path.write_text(text)
        try:
            return row | {"result": _result(folder, mutant.file, limit_s, stage)}
        finally:
            path.write_text(original)
            os.utime(path, ns=(status.st_atime_ns, status.st_mtime_ns))


def _result(folder: Path, file: str, limit_s: float, stage: str) -> str:
    """Verdict of a stage's tests.

    The nearest ones are asked without compilation, which takes longer than most tests of a single function.
    """
    compiled, nearest = is_compiled(folder, file), files_judging(folder, file)
    if stage == "nearest":
        return verdict(folder, nearest[:1], limit_s, compiled=not compiled) if nearest else "untested"
    room = nearest if compiled else nearest[1:]
    tests = room if stage == "room" else files_elsewhere(folder, file)
    return verdict(folder, tests, limit_s) if tests else "survived"


def check_tests(folder: Path, mutants: Sequence[Mutant]) -> None:
    """Refuse to go on where a test fails without any mutation: it would kill every mutant.

    Raises:
        InputError: names the test files.
    """
    tests = sorted({test for mutant in mutants for test in files_judging(folder, mutant.file)})
    if (result := verdict(folder, tests, CHECK_LIMIT_S)) != "survived":
        raise InputError(
            f"the unchanged code does not pass its own tests ({result}): pytest {' '.join(tests)}"
        )


def lines(rows: Sequence[dict[str, Any]]) -> list[str]:
    """Table per package, without equivalent mutants, then every mutant that no test noticed.

    Shares are of mutants that the tests of a stage and of those before it have noticed.
    """
    table = [f"{'package':12s} {'mutants':>8s} " + " ".join(f"{stage:>8s}" for stage in STAGES)]
    for package in (*PACKAGES, "all"):
        chosen = [row for row in rows if package in ("all", row["file"].split("/")[0])]
        count = sum(row["result"] != "equivalent" for row in chosen)
        by = Counter(row["by"] for row in chosen if row["result"] == "killed")
        if count:
            shares = np.cumsum([by[stage] for stage in STAGES]) / count
            table.append(f"{package:12s} {count:8d} " + " ".join(f"{share:8.1%}" for share in shares))
    left = [row for row in rows if row["result"] not in ("killed", "equivalent")]
    return table + [f"{row['file']}:{row['line']}: {row['change']} ({row['result']})" for row in left]


def _is_open(row: dict[str, Any] | None, stage: int) -> bool:
    """Whether a mutant is still to be judged in a stage: unseen, or left over by the stage before."""
    if row is None:
        return stage == 0
    return row["result"] not in ("killed", "equivalent") and STAGES.index(row["by"]) == stage - 1


def _lines(path: Path) -> list[str]:
    return path.read_text().splitlines() if path.exists() else []


@command
def main(arguments: Sequence[str] | None = None) -> None:
    """Judge the mutants and print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--mutants", type=int, default=300)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--packages", nargs="+", default=list(PACKAGES))
    parser.add_argument("--limit-s", type=float, default=120.0, help="time of a mutant's tests")
    parser.add_argument("--json", type=Path, required=True, help="file of results, one line a mutant")
    parser.add_argument("--unchecked", action="store_true", help="leave out the tests of the unchanged code")
    parser.add_argument("--until", choices=STAGES, default="room", help="last stage of the tests")
    options = parser.parse_args(arguments)
    rows = {(row["file"], row["number"]): row for row in map(json.loads, _lines(options.json))}
    preload()
    with tempfile.TemporaryDirectory() as scratch, options.json.open("a") as out:
        folder = copied(ROOT, Path(scratch) / "copy")
        mutants = drawn(folder, options.packages, options.mutants, options.seed)
        if not options.unchecked:
            check_tests(folder, mutants)
        for stage, name in enumerate(STAGES[: STAGES.index(options.until) + 1]):
            for mutant in mutants:
                key = mutant.file, mutant.number
                if _is_open(rows.get(key), stage):
                    rows[key] = judged(folder, mutant, options.limit_s, name)
                    print(json.dumps(rows[key]), file=out, flush=True)
    print("\n".join(lines(list(rows.values()))))


if __name__ == "__main__":
    raise SystemExit(main())
