"""Options shared by the commands that run cases."""

import argparse
import os
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

from foreride.controller.registry import CONTROLLERS
from foreride.controller.settings import ControllerSettings
from foreride.files.command_line import STDOUT, output_path
from foreride.files.errors import InputError, shown
from foreride.files.own_code import FMUS_ALLOWED, say_once
from foreride.files.reading import strict, yaml12
from foreride.files.reading.numbers import parse_whole_numbers, within
from foreride.files.reading.ranges import MAX_SEED
from foreride.files.reading.regular_file import read_text
from foreride.files.writing.sharing import shared_target
from foreride.scenarios.cases import Case, cases, distinct
from foreride.scenarios.commands.console import progress_bar
from foreride.scenarios.comparison.parallel import simulate_each
from foreride.scenarios.comparison.table import short_name
from foreride.scenarios.definition.doubts import doubts_of_metrics, doubts_of_scenario
from foreride.scenarios.definition.overrides import Override, collect_overrides, parse_override
from foreride.scenarios.definition.sets import load_all
from foreride.scenarios.perceptions.registry import PERCEPTIONS
from foreride.scenarios.runs.record import vehicle_name
from foreride.scenarios.simulation.referenced_files import check_case_files
from foreride.scenarios.simulation.simulate import Run


def comma_list(text: str) -> list[str]:
    """Split `a,b,c` into its parts; what is named twice counts once."""
    parts = list(dict.fromkeys(part.strip() for part in text.split(",") if part.strip()))
    if not parts:
        raise argparse.ArgumentTypeError(f"must name at least one, got {shown(text)}")
    return parts


def add_case_options(command: argparse.ArgumentParser, controllers: str, perceptions: str) -> None:
    """Add the options that select the cases: controllers, perception, seeds, and scenario fields."""
    names, ladder = comma_list(controllers), comma_list(perceptions)
    own = f"{', '.join(CONTROLLERS.names())}, or your own as path/to/file.py:name (default {controllers})"
    command.add_argument("--controllers", type=comma_list, default=names, metavar="A,B,...", help=own)
    known = f"{', '.join(PERCEPTIONS.names())} (default {perceptions})"
    command.add_argument("--perception", type=comma_list, default=ladder, metavar="A,B,...", help=known)
    command.add_argument(
        "--seeds", type=comma_list, metavar="0,1,5-9,...", help="override the scenario's; each runs once"
    )
    command.add_argument(
        "--jobs", type=int, default=1, metavar="N", help="worker processes (default 1; 0 for all cores)"
    )
    add_field_options(command)
    add_output_options(command)


def jobs_of(arguments: argparse.Namespace) -> int:
    """Number of worker processes requested."""
    within("--jobs", arguments.jobs, 0, 1024)
    return arguments.jobs or os.cpu_count() or 1


def add_frames_option(command: argparse.ArgumentParser) -> None:
    """Add `--frames`."""
    told = "keep the camera images in the run folders (for reports and videos)"
    command.add_argument("--frames", action="store_true", help=told)


def add_field_options(command: argparse.ArgumentParser) -> None:
    """Add the options that override scenario fields."""
    command.add_argument(
        "--vehicle", metavar="MODEL", help="quarter, half, full, or a YAML file of parameters"
    )
    command.add_argument("--observer", choices=("truth", "sensors"), help="overrides the scenario's observer")
    command.add_argument(
        "--settings", type=Path, metavar="FILE", help="controller settings, as written by `foreride tune`"
    )
    add_fmu_option(command)
    command.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="PATH.TO.FIELD=VALUE",
        dest="overrides",
        help="set any scenario field, as camera.rate_hz=30 or, for an entry of a list, "
        "road.features.0.height_m=0.1 or road.features[0].height_m=0.1; may be repeated",
    )


def add_fmu_option(command: argparse.ArgumentParser) -> None:
    """Add `--allow-fmu`."""
    told = "run the machine code of the FMU that a scenario names"
    command.add_argument("--allow-fmu", action="store_true", help=told)


def apply_fmu_option(arguments: argparse.Namespace) -> None:
    """Let `--allow-fmu` take effect, in worker processes of this machine too, which inherit it."""
    if arguments.allow_fmu:
        os.environ[FMUS_ALLOWED] = "1"


def add_json_option(command: argparse.ArgumentParser, told: str = "write the numbers as JSON") -> None:
    """Add `--json`."""
    told = f"{told}; {STDOUT} is standard output"
    command.add_argument("--json", type=output_path, metavar="FILE", help=told)


def add_output_options(command: argparse.ArgumentParser) -> None:
    """Add `--json` and `--out`."""
    add_json_option(command)
    command.add_argument("--out", type=Path, metavar="DIR", help="output folder")


def overrides_of(arguments: argparse.Namespace) -> list[Override]:
    """Overrides of `--set`, `--vehicle`, `--observer` and `--settings`; `--allow-fmu` takes effect here."""
    apply_fmu_option(arguments)
    overrides = [] if arguments.settings is None else settings_overrides(arguments.settings)
    overrides += [parse_override(text) for text in arguments.overrides]
    if arguments.vehicle:
        overrides.append(Override(("vehicle", "model"), arguments.vehicle, "--vehicle"))
    if arguments.observer:
        overrides.append(Override(("observer",), arguments.observer, "--observer"))
    return overrides


def settings_overrides(path: Path) -> list[Override]:
    """Overrides equivalent to a file of controller settings; fields it omits stay unchanged."""
    strict.read(ControllerSettings, path)
    settings = yaml12.parse(read_text(path), str(path))
    return list(collect_overrides({"control": {"settings": settings}}))


def seeds_of(arguments: argparse.Namespace) -> list[int] | None:
    """Parse `--seeds`; None leaves each scenario its own."""
    if arguments.seeds is None:
        return None
    return parse_whole_numbers("--seeds", arguments.seeds, MAX_SEED)


def cases_of(arguments: argparse.Namespace, names: Iterable[str]) -> list[Case]:
    """Cases selected by the command line, in order, after checking the files that they name."""
    scenarios = load_all(names, overrides_of(arguments))
    selected = distinct(cases(scenarios, arguments.controllers, arguments.perception, seeds_of(arguments)))
    _check_names(selected)
    for case in selected:
        check_case_files(case)
    for scenario in scenarios:
        _say(scenario.name, doubts_of_scenario(scenario))
    return selected


def _say(subject: str, doubts: Iterable[str]) -> None:
    for doubt in doubts:
        say_once(f"{subject} {doubt}", f"{subject}: {doubt}")


def _check_names(selected: Sequence[Case]) -> None:
    """Raise InputError for different files of one name, which tables and manifests could not tell apart."""
    for kind, files in (
        ("--controllers", {(shared_target(case.controller), case.controller) for case in selected}),
        ("--vehicle", {(vehicle_name(case.scenario), case.scenario.vehicle.model) for case in selected}),
    ):
        if len(files) > len(names := {name for name, _ in files}):
            listed = ", ".join(sorted(names))
            raise InputError(f"{kind}: two files have the same name (of {listed}); each must have its own")


def simulate_all(selected: Sequence[Case], keep_images: bool = False, jobs: int = 1) -> list[Run]:
    """Run the cases with a progress bar."""
    return list(simulated(selected, keep_images, jobs))


def simulated(selected: Sequence[Case], keep_images: bool = False, jobs: int = 1) -> Iterator[Run]:
    """Yield the run of each case, in order, with a progress bar."""
    with progress_bar() as progress:
        bar = progress.add_task("", total=sum(case.scenario.ticks for case in selected))

        def advance(case: Case, ticks: int) -> None:
            description = f"{case.scenario.name} {short_name(case.controller)} {case.perception}"
            progress.update(bar, description=description, advance=ticks)

        for run in simulate_each(selected, jobs, keep_images, advance):
            _say(run.case.scenario.name, doubts_of_metrics(run.metrics))
            yield run
