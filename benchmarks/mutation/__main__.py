"""Mutation score of packages: `python -m benchmarks.mutation --mutants 300 --seed 0 --json FILE`.

First the tests of the packages are recorded (`reach`), then each mutant is judged by those that execute its
function: all mutants by the module's own test file, the survivors by the others. Tests that take longer
together than `--tests-s` are left out, so the score is a lower bound of what the suite notices. Mutants that
are provably the same code are counted apart (`equivalent.yaml`). A result is written per mutant and stage; an
interrupted run goes on from its file.
"""

import argparse
import json
import os
import tempfile
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.command import command
from benchmarks.mutation.choice import Mutant, drawn, function_at, judging, own_tests, test_files, within_time
from benchmarks.mutation.equivalent import reason
from benchmarks.mutation.judge import copied, preload, verdict
from benchmarks.mutation.machine_code import code_aside, is_compiled
from benchmarks.mutation.operators import mutated
from benchmarks.mutation.reach import TestReach, recorded

ROOT = Path(__file__).parents[2]
PACKAGES = ("controller", "vehicle", "preview", "comfort")
STAGES = ("own", "reach")
"""Tests that judge: the module's own file, then those elsewhere that execute the function."""

SPARE_S, COMPILE_S = 10.0, 60.0
SLOWER = 5
"""A mutant whose tests take this many times their time and the spare seconds is noticed: it hangs."""


@dataclass(frozen=True)
class Bench:
    """Copy of the repository, its recorded tests (with Numba, without it) and the time for one mutant."""

    folder: Path
    tests: Sequence[TestReach]
    plain_tests: Sequence[TestReach]
    tests_s: float = 30.0


def judged(bench: Bench, mutant: Mutant, stage: str = "own") -> dict[str, Any]:
    """Result of one mutant by the tests of a stage; the copy is as before afterwards."""
    path = bench.folder / mutant.file
    original, status = path.read_text(), path.stat()
    text, line, words = mutated(original, mutant.number)
    row = {"file": mutant.file, "number": mutant.number, "line": line, "change": words, "by": stage}
    if reason(bench.folder, row) is not None:
        return row | {"result": "equivalent"}
    function = function_at(original, line)
    with code_aside(bench.folder, mutant.file):
        path.write_text(text)
        try:
            return row | {"result": _result(bench, mutant.file, function, stage)}
        finally:
            path.write_text(original)
            os.utime(path, ns=(status.st_atime_ns, status.st_mtime_ns))


def _result(bench: Bench, file: str, function: str | None, stage: str) -> str:
    """Verdict of a stage's tests.

    A compiled module's own tests run without compilation, which takes longer than most tests of a single
    function. The tests elsewhere run with it; calls of compiled functions are not recorded there.
    """
    compiled, own = is_compiled(bench.folder, file), own_tests(bench.folder, file)
    plain = compiled and stage == "own"
    tests = judging(
        bench.folder,
        file,
        None if compiled and not plain else function,
        bench.plain_tests if plain else bench.tests,
    )
    tests = [test for test in tests if (test.file == own) == (stage == "own") or (compiled and not plain)]
    if not (chosen := within_time(tests, bench.tests_s)):
        return "survived"
    limit_s = SPARE_S + SLOWER * sum(test.seconds for test in chosen) + COMPILE_S * compiled
    return verdict(bench.folder, [test.name for test in chosen], limit_s, compiled=not plain)


def lines(rows: Sequence[dict[str, Any]]) -> list[str]:
    """Table per package, without equivalent mutants, then every mutant that no test noticed.

    Shares are of mutants that the tests of a stage and of those before it have noticed.
    """
    table = [f"{'package':12s} {'mutants':>8s} " + " ".join(f"{stage:>8s}" for stage in STAGES)]
    for package in (*PACKAGES, "all"):
        chosen = [row for row in rows if package in ("all", row["file"].split("/")[0])]
        count = sum(row["result"] != "equivalent" for row in chosen)
        by = Counter(row["by"] for row in chosen if row["result"] in ("killed", "timeout"))
        if count:
            shares = np.cumsum([by[stage] for stage in STAGES]) / count
            table.append(f"{package:12s} {count:8d} " + " ".join(f"{share:8.1%}" for share in shares))
    left = [row for row in rows if row["result"] == "survived"]
    return table + [f"{row['file']}:{row['line']}: {row['change']}" for row in left]


def _is_open(row: dict[str, Any] | None, stage: int) -> bool:
    """Whether a mutant is still to be judged in a stage: unseen, or left over by the stage before."""
    if row is None:
        return stage == 0
    return row["result"] == "survived" and STAGES.index(row["by"]) == stage - 1


def _lines(path: Path) -> list[str]:
    return path.read_text().splitlines() if path.exists() else []


def _bench(folder: Path, reach: Path, tests_s: float, mutants: Sequence[Mutant]) -> Bench:
    """Copy with all tests recorded that judge some mutants."""
    mirrored = (own_tests(folder, mutant.file) for mutant in mutants if is_compiled(folder, mutant.file))
    return Bench(
        folder,
        recorded(folder, test_files(folder, PACKAGES), reach),
        recorded(folder, sorted({file for file in mirrored if file}), reach, compiled=False),
        tests_s,
    )


@command
def main(arguments: Sequence[str] | None = None) -> None:
    """Judge the mutants and print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--mutants", type=int, default=300)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--packages", nargs="+", default=list(PACKAGES))
    parser.add_argument("--tests-s", type=float, default=30.0, help="time of the tests of a mutant and stage")
    parser.add_argument("--json", type=Path, required=True, help="file of results, one line a mutant")
    parser.add_argument("--reach", type=Path, help="file of recorded tests (FILE.reach)")
    parser.add_argument("--until", choices=STAGES, default=STAGES[-1], help="last stage of the tests")
    options = parser.parse_args(arguments)
    rows = {(row["file"], row["number"]): row for row in map(json.loads, _lines(options.json))}
    preload()
    with tempfile.TemporaryDirectory() as scratch, options.json.open("a") as out:
        folder = copied(ROOT, Path(scratch) / "copy")
        mutants = drawn(folder, options.packages, options.mutants, options.seed)
        reach = options.reach or options.json.with_name(options.json.name + ".reach")
        bench = _bench(folder, reach, options.tests_s, mutants)
        for stage, name in enumerate(STAGES[: STAGES.index(options.until) + 1]):
            for mutant in mutants:
                key = mutant.file, mutant.number
                if _is_open(rows.get(key), stage):
                    rows[key] = judged(bench, mutant, name)
                    print(json.dumps(rows[key]), file=out, flush=True)
    print("\n".join(lines(list(rows.values()))))


if __name__ == "__main__":
    raise SystemExit(main())
