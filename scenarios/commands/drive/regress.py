"""`foreride regress`: ride metrics checked against a committed baseline."""

import argparse
from collections.abc import Sequence
from dataclasses import asdict, replace
from importlib.metadata import version
from pathlib import Path

from foreride.files.errors import InputError
from foreride.files.writing.atomic import write_text
from foreride.files.writing.targets import check_files
from foreride.scenarios.commands.options import (  # fmt: skip
    add_case_options,
    cases_of,
    console,
    jobs_of,
    overrides_of,
    simulated,
)
from foreride.scenarios.regression.baseline import (
    REFERENCE,
    Baseline,
    BaselineEntry,
    read,
    relative_name,
    write,
)
from foreride.scenarios.regression.tolerances import Change, changes, diff, failed, label, measured
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
    held = _named(arguments) if arguments.scenarios else baseline.held
    if not held:
        raise InputError(f"{path}: holds no cases; name scenarios and --accept to add some")
    driven = [one.case(path.parent) for one in held]
    now = [measured(run) for run in simulated(driven, jobs=jobs_of(arguments))]
    if arguments.accept:
        write(path, baseline.with_entries([replace(o, metrics=m) for o, m in zip(held, now, strict=True)]))
        console.print(f"baseline: {path} ({len(held)} cases written)")
        return 0
    tolerances = baseline.own_tolerances()
    found = [changes(one.metrics, metrics, tolerances) for one, metrics in zip(held, now, strict=True)]
    labels = [label(case, one.override_texts) for case, one in zip(driven, held, strict=True)]
    _tell(labels, found, baseline.foreride)
    if arguments.json:
        rows = [
            {"case": name, "failed": failed(moved), "changes": [asdict(c) | _judged(c) for c in moved]}
            for name, moved in zip(labels, found, strict=True)
        ]
        write_text(arguments.json, to_json({"schema": 1, "baseline": str(path), "rows": rows}) + "\n")
    return CHECK_FAILED if any(failed(moved) for moved in found) else 0


def _named(arguments: argparse.Namespace) -> list[BaselineEntry]:
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


def _tell(labels: Sequence[str], found: Sequence[Sequence[Change]], wrote: str) -> None:
    """Print the changes case by case, and their total."""
    for name, moved in zip(labels, found, strict=True):
        if moved:
            console.print(f"{'FAILED' if failed(moved) else 'moved '} {name}", highlight=False)
            for line in diff(moved):
                console.print(f"         {line}", highlight=False, soft_wrap=True)
    lost = sum(failed(moved) for moved in found)
    calm = sum(not moved for moved in found)
    since = "" if wrote == version("foreride") else f"; the baseline is of foreride {wrote}"
    other = len(found) - calm - lost
    console.print(f"{len(found)} cases: {calm} hold, {lost} got worse, {other} moved otherwise{since}")
    if calm < len(found):
        console.print("to take what is measured now as the new baseline: --accept")
