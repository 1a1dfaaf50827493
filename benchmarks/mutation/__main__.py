"""Mutation score of packages: `python -m benchmarks.mutation --mutants 300 --seed 0 --json FILE`.

Each mutant is judged by the tests of its module and room alone, so the score is a lower bound of what the
whole suite notices. A result is written per mutant; an interrupted run goes on from its file.
"""

import argparse
import json
import tempfile
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from benchmarks.command import command
from benchmarks.mutation.choice import Mutant, drawn, files_judging
from benchmarks.mutation.judge import copied, preload, verdict
from benchmarks.mutation.operators import mutated
from foreride.files.errors import InputError

ROOT = Path(__file__).parents[2]
PACKAGES = ("controller", "vehicle", "preview", "comfort")
CHECK_LIMIT_S = 3600.0


def judged(folder: Path, mutant: Mutant, limit_s: float) -> dict[str, object]:
    """Result of one mutant; the copy is as before afterwards."""
    path = folder / mutant.file
    original = path.read_text()
    text, line, words = mutated(original, mutant.number)
    path.write_text(text)
    try:
        tests = files_judging(folder, mutant.file)
        result = verdict(folder, tests, limit_s) if tests else "untested"
    finally:
        path.write_text(original)
    return {"file": mutant.file, "number": mutant.number, "line": line, "change": words, "result": result}


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


def lines(rows: Sequence[dict[str, object]]) -> list[str]:
    """Table per package, then every mutant that no test noticed."""
    table = [f"{'package':12s} {'mutants':>8s} {'noticed':>8s} {'share':>6s}"]
    for package in (*PACKAGES, "all"):
        of = Counter(row["result"] for row in rows if package in ("all", str(row["file"]).split("/")[0]))
        seen = of["killed"] + of["timeout"]
        if of.total():
            table.append(f"{package:12s} {of.total():8d} {seen:8d} {seen / of.total():6.1%}")
    left = [row for row in rows if row["result"] not in ("killed", "timeout")]
    return table + [f"{row['file']}:{row['line']}: {row['change']} ({row['result']})" for row in left]


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
    options = parser.parse_args(arguments)
    rows = [json.loads(line) for line in _lines(options.json)]
    done = {(row["file"], row["number"]) for row in rows}
    preload()
    with tempfile.TemporaryDirectory() as scratch, options.json.open("a") as out:
        folder = copied(ROOT, Path(scratch))
        mutants = drawn(folder, options.packages, options.mutants, options.seed)
        if not options.unchecked:
            check_tests(folder, mutants)
        for mutant in mutants:
            if (mutant.file, mutant.number) not in done:
                rows.append(judged(folder, mutant, options.limit_s))
                print(json.dumps(rows[-1]), file=out, flush=True)
    print("\n".join(lines(rows)))


if __name__ == "__main__":
    raise SystemExit(main())
