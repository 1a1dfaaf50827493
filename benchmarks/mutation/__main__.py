"""Mutation score of packages: `python -m benchmarks.mutation --mutants 300 --seed 0 --json FILE`.

Each mutant is judged by the tests of its module and room alone, so the score is a lower bound of what the
whole suite notices; `--wider` tries the survivors against the tests elsewhere that reach the module and
against those that drive. Mutants that are provably the same code are counted apart (`equivalent.yaml`). A
result is written per mutant; an interrupted run goes on from its file. Tests that take longer than the limit
count as not noticing.
"""

import argparse
import json
import os
import tempfile
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

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
NOTICED = ("killed", "elsewhere", "equivalent")


def judged(folder: Path, mutant: Mutant, limit_s: float, wider: bool = False) -> dict[str, Any]:
    """Result of one mutant, by its own tests or by those elsewhere; the copy is as before afterwards."""
    path = folder / mutant.file
    original, status = path.read_text(), path.stat()
    text, line, words = mutated(original, mutant.number)
    row = {"file": mutant.file, "number": mutant.number, "line": line, "change": words}
    if reason(folder, row) is not None:
        return row | {"result": "equivalent"}
    tests = (files_elsewhere if wider else files_judging)(folder, mutant.file)
    compiled = is_compiled(folder, mutant.file)
    with code_aside(folder, mutant.file):
        path.write_text(text)
        try:
            result = _result(folder, tests, limit_s, compiled)
        finally:
            path.write_text(original)
            os.utime(path, ns=(status.st_atime_ns, status.st_mtime_ns))
    if wider:
        return row | {"result": "elsewhere" if result == "killed" else "survived", "wider": True}
    return row | {"result": result}


def _result(folder: Path, tests: Sequence[str], limit_s: float, compiled: bool) -> str:
    """Verdict of the nearest test file, which most often settles it, then of the others.

    The first is asked without compilation, which takes longer than most tests of a single function.
    """
    if not tests:
        return "untested"
    nearest = verdict(folder, tests[:1], limit_s / 4.0, compiled=not compiled)
    rest = tests if compiled or nearest == "timeout" else tests[1:]
    return verdict(folder, rest, limit_s) if rest and nearest != "killed" else nearest


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
    """Table per package, without equivalent mutants, then every mutant that no test noticed."""
    table = [f"{'package':12s} {'mutants':>8s} {'noticed':>8s} {'share':>6s} {'by suite':>8s}"]
    for package in (*PACKAGES, "all"):
        of = Counter(row["result"] for row in rows if package in ("all", row["file"].split("/")[0]))
        seen = of["killed"]
        if count := of.total() - of.pop("equivalent", 0):
            suite = (seen + of["elsewhere"]) / count
            table.append(f"{package:12s} {count:8d} {seen:8d} {seen / count:6.1%} {suite:8.1%}")
    left = [row for row in rows if row["result"] not in NOTICED]
    return table + [f"{row['file']}:{row['line']}: {row['change']} ({row['result']})" for row in left]


def _is_open(row: dict[str, Any] | None, wider: bool) -> bool:
    """Whether a mutant is still to be judged: unseen, or in the second pass a survivor of the first."""
    if wider:
        return row is not None and row["result"] in ("survived", "untested") and not row.get("wider")
    return row is None


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
    parser.add_argument("--wider", action="store_true", help="judge survivors by tests elsewhere and drives")
    options = parser.parse_args(arguments)
    rows = {(row["file"], row["number"]): row for row in map(json.loads, _lines(options.json))}
    preload()
    with tempfile.TemporaryDirectory() as scratch, options.json.open("a") as out:
        folder = copied(ROOT, Path(scratch) / "copy")
        mutants = drawn(folder, options.packages, options.mutants, options.seed)
        if not options.unchecked:
            check_tests(folder, mutants)
        for wider in (False, True)[: 1 + options.wider]:
            for mutant in mutants:
                key = mutant.file, mutant.number
                if _is_open(rows.get(key), wider):
                    rows[key] = judged(folder, mutant, options.limit_s, wider)
                    print(json.dumps(rows[key]), file=out, flush=True)
    print("\n".join(lines(list(rows.values()))))


if __name__ == "__main__":
    raise SystemExit(main())
