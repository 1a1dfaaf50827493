"""`foreride validation`: all checks against independent references, as a table."""

import argparse
import math
from pathlib import Path
from typing import Any

from foreride.files.writing.atomic import write_text
from foreride.scenarios.commands.console import console, tracked, verdict
from foreride.scenarios.commands.options import add_json_option
from foreride.scenarios.runs.write import environment, to_json
from foreride.scenarios.validation.areas import count, run_all
from foreride.scenarios.validation.check import Check

_HEAD = """# Validation

Made by `make validation`. Each row compares foreride with something that is not foreride; the deviation is
the largest one over all values compared, and a row passes when it is inside its bound.
"""


def configure(command: argparse.ArgumentParser) -> None:
    """Add the options, and the function to execute."""
    command.add_argument("--out", type=Path, metavar="FILE", help="write the table as Markdown")
    add_json_option(command, "write the rows as JSON")
    command.set_defaults(execute=execute, out_is_file=True)


def execute(arguments: argparse.Namespace) -> int:
    """Run all checks; exit code 1 if one failed."""
    rows = list(tracked(run_all(), "checks", count()))
    for area, check in rows:
        measured = f"{_shown(check, check.deviation)} of {_shown(check, check.bound)}"
        line = f"{area}: {check.name}: {measured} ({check.reference})"
        console.print(verdict(check.passed), line, highlight=False)
    failed = sum(not check.passed for _, check in rows)
    console.print(f"{len(rows) - failed} of {len(rows)} checks passed")
    if arguments.out:
        write_text(arguments.out, markdown(rows))
    if arguments.json:
        checks = [_entry(area, check) for area, check in rows]
        document = {"schema": 1, "manifest": environment(), "passed": failed == 0, "checks": checks}
        write_text(arguments.json, to_json(document) + "\n")
    return 1 if failed else 0


def _entry(area: str, check: Check) -> dict[str, Any]:
    deviation = check.deviation if math.isfinite(check.deviation) else None  # JSON has no infinity
    return {"area": area, **vars(check), "deviation": deviation, "passed": check.passed}


def markdown(rows: list[tuple[str, Check]]) -> str:
    """Document with one table per area."""
    lines = [_HEAD]
    for area in dict.fromkeys(area for area, _ in rows):
        lines += [f"## {area}\n", "| check | reference | deviation | bound | |", "|---|---|---|---|---|"]
        for check in (check for of, check in rows if of == area):
            verdict = "pass" if check.passed else "**FAIL**"
            measured = f"{_shown(check, check.deviation)} | {_shown(check, check.bound)}"
            lines.append(f"| {check.name} | {check.reference} | {measured} | {verdict} |")
        lines.append("")
    return "\n".join(lines)


def _shown(check: Check, value: float) -> str:
    """Value with two significant figures and unit; ratios in per cent."""
    return f"{value:.2g} {check.unit}" if check.unit else f"{100 * value:.2g} %"
