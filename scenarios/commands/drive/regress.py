"""`foreride regress`: ride metrics checked against a committed baseline."""

import argparse
from collections.abc import Sequence
from dataclasses import asdict, replace
from importlib.metadata import version
from pathlib import Path

from foreride.files.errors import InputError
from foreride.files.writing.atomic import write_text
from foreride.files.writing.targets import check_files
from foreride.scenarios.commands.console import console
from foreride.scenarios.commands.options import add_case_options, cases_of, jobs_of, overrides_of, simulated
from foreride.scenarios.regression.baseline import (
    REFERENCE,
    Baseline,
    BaselineEntry,
    read,
    relative_name,
    write,
)
from foreride.scenarios.regression.tolerances import (
    Change,
    baseline_values,
    change_lines,
    changes,
    failed,
    holds,
    label,
)
from foreride.scenarios.runs.write import to_json

CHECK_FAILED = 1


def configure(command: argparse.ArgumentParser) -> None:
    """Add the options, and the function to execute."""
    named = "with --accept: cases to add to or update in the baseline"
    command.add_argument("scenarios", nargs="*", metavar="SCENARIO", help=named)
    told = "the baseline file (default: that of foreride's own reference events)"
    command.add_argument("--baseline", type=Path, default=REFERENCE, metavar="FILE", help=told)
    renew = "write the present metrics into the baseline instead of comparing"
    command.add_argument("--accept", action="store_true", help=renew)
    add_case_options(command, "passive,skyhook,mpc_reactive,mpc_preview", "oracle")
    command.set_defaults(execute=execute)


def execute(arguments: argparse.Namespace) -> int:
    """Run the baseline's cases; exit code 1 if a metric is worse than its tolerance allows."""
    if arguments.scenarios and not arguments.accept:
        raise InputError("scenarios are named only with --accept, which adds them to the baseline")
    path: Path = arguments.baseline
    if arguments.accept:
        check_files(path)
    baseline = Baseline() if arguments.scenarios and not path.exists() else read(path)
    entries = _new_entries(arguments) if arguments.scenarios else baseline.entries
    if not entries:
        raise InputError(f"{path}: holds no cases; name scenarios and --accept to add some")
    selected = [entry.case(path.parent) for entry in entries]
    results = [baseline_values(run) for run in simulated(selected, jobs=jobs_of(arguments))]
    if arguments.accept:
        accepted = [replace(entry, metrics=m) for entry, m in zip(entries, results, strict=True)]
        write(path, baseline.with_entries(accepted))
        console.print(f"baseline: {path} ({len(entries)} cases written)")
        return 0
    tolerances = baseline.own_tolerances()
    changes_by_case = [
        changes(entry.metrics, metrics, tolerances) for entry, metrics in zip(entries, results, strict=True)
    ]
    labels = [label(case, entry.override_texts) for case, entry in zip(selected, entries, strict=True)]
    _print_changes(labels, changes_by_case, baseline.foreride)
    if arguments.json:
        rows = [
            {
                "case": name,
                "failed": failed(case_changes),
                "changes": [asdict(c) | _judged(c) for c in case_changes],
            }
            for name, case_changes in zip(labels, changes_by_case, strict=True)
        ]
        write_text(arguments.json, to_json({"schema": 1, "baseline": str(path), "rows": rows}) + "\n")
    return CHECK_FAILED if any(failed(case_changes) for case_changes in changes_by_case) else 0


def _new_entries(arguments: argparse.Namespace) -> list[BaselineEntry]:
    """Baseline entries for the cases on the command line, without metrics yet."""
    folder, overrides = arguments.baseline.parent, tuple(overrides_of(arguments))
    named = ((name, case) for name in arguments.scenarios for case in cases_of(arguments, [name]))
    return [
        BaselineEntry(
            scenario=relative_name(folder, name),
            overrides=overrides,
            controller=relative_name(folder, case.controller),
            perception=case.perception,
            seed=case.seed,
            metrics={},
        )
        for name, case in named
    ]


def _judged(change: Change) -> dict[str, object]:
    return {"verdict": change.verdict, "of_tolerance": change.used}


def _print_changes(
    labels: Sequence[str], changes_by_case: Sequence[Sequence[Change]], baseline_version: str
) -> None:
    """Print the changes case by case, and their total."""
    for name, case_changes in zip(labels, changes_by_case, strict=True):
        if case_changes:
            told = "FAILED" if failed(case_changes) else "lacks " if holds(case_changes) else "moved "
            console.print(f"{told} {name}", highlight=False)
            for line in change_lines(case_changes):
                console.print(f"         {line}", highlight=False, soft_wrap=True)
    worse = sum(failed(case_changes) for case_changes in changes_by_case)
    unchanged = sum(holds(case_changes) for case_changes in changes_by_case)
    lacking = sum(any(c.verdict == "new" for c in case_changes) for case_changes in changes_by_case)
    same_version = baseline_version == version("foreride")
    version_note = "" if same_version else f"; the baseline is of foreride {baseline_version}"
    other = len(changes_by_case) - unchanged - worse
    counts = f"{unchanged} hold, {worse} got worse, {other} moved otherwise"
    counts += f"; the baseline lacks metrics of {lacking}" if lacking else ""
    console.print(f"{len(changes_by_case)} cases: {counts}{version_note}")
    if any(changes_by_case):
        console.print("to take what is measured now as the new baseline: --accept")
