"""`foreride tune`: tuning of the reactive controllers on roads that no report uses."""

import argparse

from foreride.controller.tuned_settings import TUNED_CONTROLLERS
from foreride.files.errors import InputError
from foreride.files.reading import strict
from foreride.files.reading.numbers import within
from foreride.files.writing.atomic import write_text
from foreride.files.writing.targets import check_files
from foreride.scenarios.commands.console import console, progress_bar, suggest
from foreride.scenarios.commands.options import (
    add_field_options,
    add_output_options,
    comma_list,
    overrides_of,
)
from foreride.scenarios.commands.outputs import runs_folder
from foreride.scenarios.definition.schema import Scenario
from foreride.scenarios.definition.sets import load_all
from foreride.scenarios.runs.write import environment, to_json
from foreride.scenarios.studies.tuning import Tuned, TuningObjective, search_ranges, tune, with_settings


def configure(command: argparse.ArgumentParser) -> None:
    """Add the options, and the function to execute."""
    command.add_argument(
        "events", nargs="*", default=["tuning"], metavar="SCENARIO", help="scenarios or sets (default tuning)"
    )
    names = ",".join(TUNED_CONTROLLERS)
    command.add_argument(
        "--controllers",
        type=comma_list,
        default=list(TUNED_CONTROLLERS),
        metavar="A,B,...",
        help=f"default {names}",
    )
    command.add_argument(
        "--evaluations",
        type=int,
        default=24,
        metavar="N",
        help="evaluations of the set per controller (default 24)",
    )
    command.add_argument("--seed", type=int, default=1, help="seed of the search (default 1)")
    add_field_options(command)
    add_output_options(command)
    command.set_defaults(execute=execute, out_is_file=True)


def execute(arguments: argparse.Namespace) -> int:
    """Tune one controller after the other; write the settings to `--out` (default runs/tuned/KIND.yaml)."""
    within("--evaluations", arguments.evaluations, 8, 10_000)
    within("--seed", arguments.seed, 0, 2**32 - 1)
    scenarios = load_all(arguments.events, overrides_of(arguments))
    car = scenarios[0].vehicle.parameters
    if any(scenario.vehicle.parameters != car for scenario in scenarios):
        raise InputError("tuning scenarios must all have the same car; --vehicle sets it")
    searches = {name: search_ranges(name, car) for name in arguments.controllers}
    out = arguments.out or runs_folder(None) / "tuned" / f"{car.kind}.yaml"
    check_files(out)
    results = []
    with progress_bar() as progress:
        bar = progress.add_task("passive", total=len(searches) * arguments.evaluations)
        judge = TuningObjective(scenarios, lambda: progress.advance(bar))
        for name, spans in searches.items():
            progress.update(bar, description=name)
            previous = strict.to_mapping(getattr(scenarios[0].control.settings, name))
            tuned = tune(judge, name, spans, previous, arguments.evaluations, arguments.seed)
            progress.console.print(
                f"{name}: J / passive {tuned.before:.4f} → {tuned.score:.4f}  {tuned.settings}"
            )
            results.append(tuned)
            scenarios = [with_settings(scenario, name, tuned.settings) for scenario in scenarios]
    write_text(out, settings_file(scenarios[0], results, _command(arguments)))
    console.print(f"settings: {out}")
    if arguments.json:
        rows = [strict.to_mapping(tuned) for tuned in results]
        document = {"schema": 1, "manifest": environment(), "rows": rows}
        write_text(arguments.json, to_json(document) + "\n")
    suggest("foreride", "compare", "reporting", "--settings", out)
    return 0


def settings_file(scenario: Scenario, results: list[Tuned], command: str) -> str:
    """Settings of all tuned controllers as YAML, with the command that produced them and their scores."""
    scores = {tuned.controller: tuned.score for tuned in results}
    lines = [f"# Made by: {command}", "# After each: mean over the events of J relative to passive."]
    for name, values in strict.to_mapping(scenario.control.settings).items():
        if name in TUNED_CONTROLLERS:
            pairs = ", ".join(f"{key}: {value:g}" for key, value in values.items())
            score = f"  # {scores[name]:.4f}" if name in scores else ""
            lines.append(f"{name}: {{{pairs}}}{score}")
    return "\n".join(lines) + "\n"


def _command(arguments: argparse.Namespace) -> str:
    """Command line that reproduces the result."""
    parts = ["foreride tune", *arguments.events]
    if arguments.controllers != list(TUNED_CONTROLLERS):
        parts.append(f"--controllers {','.join(arguments.controllers)}")
    parts += [f"--set {override.text}" for override in overrides_of(arguments)]
    return " ".join([*parts, f"--evaluations {arguments.evaluations}", f"--seed {arguments.seed}"])
