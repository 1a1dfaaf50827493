"""`foreride sweep`: parallel execution of a study, on all cores or on a cluster, into a Parquet dataset."""

import argparse
import shlex
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path

from foreride.files.errors import InputError, shown
from foreride.files.writing.atomic import write_text
from foreride.files.writing.folder import claim, exclusive
from foreride.files.writing.names import component
from foreride.files.writing.sharing import shared_name
from foreride.scenarios.commands.console import console, progress_bar
from foreride.scenarios.commands.options import add_fmu_option, add_json_option, apply_fmu_option, jobs_of
from foreride.scenarios.commands.outputs import runs_folder
from foreride.scenarios.comparison.parallel import WorkerDied
from foreride.scenarios.runs.write import environment, to_json
from foreride.scenarios.studies.complete import missing_samples
from foreride.scenarios.studies.recipes import Recipe, read_recipe
from foreride.scenarios.studies.results import DATASET, KIND, Results
from foreride.scenarios.studies.study import Sample, read
from foreride.scenarios.studies.sweep import LOOPBACK, cluster, run

CHECK_FAILED = 1


def configure(command: argparse.ArgumentParser) -> None:
    """Add the options, and the function to execute."""
    command.add_argument("study", type=Path, metavar="STUDY", help="a YAML file")
    out = "output folder (default runs/NAME); an incomplete one is completed"
    command.add_argument("--out", type=Path, metavar="DIR", help=out)
    there = "a Dask cluster instead of this machine"
    command.add_argument("--scheduler", metavar="tcp://HOST:PORT", help=there)
    watched = "where Dask's dashboard listens, without a password (default: this machine alone)"
    command.add_argument("--dashboard", metavar="HOST:PORT", default=LOOPBACK, help=watched)
    many = "worker processes (default: all cores), or a recipe of a cluster: ssh, slurm or kubernetes"
    command.add_argument("--jobs", type=_jobs, default=0, metavar="N|FILE.yaml[:NAME]", help=many)
    command.add_argument("--retry-failed", action="store_true", help="run failed drives again")
    add_fmu_option(command)
    add_json_option(command, "write the counts as JSON")
    command.set_defaults(execute=execute)


def execute(arguments: argparse.Namespace) -> int:
    """Run the drives that are missing; every finished drive is saved at once."""
    apply_fmu_option(arguments)
    samples = {sample.key: sample for sample in read(arguments.study)}
    recipe = read_recipe(arguments.jobs) if isinstance(arguments.jobs, str) else None
    if recipe is None:
        jobs_of(arguments)
    elif arguments.scheduler is not None:
        raise InputError("--scheduler: a recipe in --jobs starts its own, give one of the two")
    out = arguments.out or runs_folder(None) / component(arguments.study.stem)
    with exclusive(claim(out, KIND)):
        return _sweep(arguments, samples, recipe, Results(out))


def _jobs(text: str) -> int | str:
    """Number of worker processes, or the file of a recipe."""
    if ".yaml" in text:
        return text
    with suppress(ValueError):
        return int(text)
    raise argparse.ArgumentTypeError(f"must be a whole number or FILE.yaml[:NAME], got {shown(text)}")


def _sweep(
    arguments: argparse.Namespace, samples: Mapping[str, Sample], recipe: Recipe | None, results: Results
) -> int:
    missing = missing_samples(samples, results, arguments.retry_failed)
    before = len(samples) - len(missing)
    if before:
        console.print(f"{before} of {len(samples)} drives are there already")
    try:
        if missing:
            jobs = min(jobs_of(arguments), len(missing)) if recipe is None else 1
            with (
                cluster(arguments.scheduler, jobs, arguments.dashboard, recipe) as client,
                progress_bar() as progress,
            ):
                bar = progress.add_task(f"{len(samples)} drives", total=len(samples), completed=before)
                run(client, missing, results, lambda: progress.advance(bar))
    except WorkerDied as death:
        kept = f"{len(results.done.keys() & samples.keys())} of {len(samples)} drives are kept"
        raise WorkerDied(
            f"{death}; {kept}; go on with: {_resume_command(arguments, results.folder)}"
        ) from None
    finally:
        results.flush()
    return CHECK_FAILED if _print_counts(arguments, samples, results) else 0


def _print_counts(arguments: argparse.Namespace, samples: Mapping[str, Sample], results: Results) -> int:
    """Print counts of drives and the first errors, write the counts to `--json`; return that of failures."""
    failed = {key: error for key, error in results.done.items() if error}
    finished = len(results.done.keys() & samples.keys())
    summary = (
        f"{finished} of {len(samples)} drives are there, {len(failed)} of them failed: {results.folder}/"
    )
    console.print(summary, highlight=False)
    for error in list(dict.fromkeys(failed.values()))[:5]:
        console.print(f"failed: {error}", highlight=False, soft_wrap=True)
    if arguments.json:
        counts = {"drives": finished, "failed": len(failed), "folder": shared_name(results.folder)}
        write_text(arguments.json, to_json({"schema": 1, "manifest": environment(), **counts}) + "\n")
    dataset = str(results.folder / DATASET)
    console.print(f"next: pandas.read_parquet({dataset!r})", highlight=False, soft_wrap=True)
    return len(failed)


def _resume_command(arguments: argparse.Namespace, folder: Path) -> str:
    """Command line that continues an interrupted sweep."""
    words = ["foreride", "sweep", str(arguments.study), "--out", str(folder)]
    words += ["--scheduler", arguments.scheduler] if arguments.scheduler else []
    words += ["--jobs", str(arguments.jobs)] if arguments.jobs else []
    words += ["--allow-fmu"] if arguments.allow_fmu else []
    return shlex.join(words)
