"""`foreride fmu`: a part of the closed loop as a functional mock-up unit (FMI co-simulation)."""

import argparse
from pathlib import Path

from foreride.files.errors import InputError
from foreride.files.reading.numbers import within
from foreride.files.reading.ranges import MAX_SEED
from foreride.scenarios.cases import Case
from foreride.scenarios.commands.console import console
from foreride.scenarios.commands.options import add_field_options, overrides_of
from foreride.scenarios.definition.loading import load
from foreride.scenarios.definition.schema import Scenario
from foreride.scenarios.fmu.c_code.package import export_c
from foreride.scenarios.fmu.embedded import PARTS
from foreride.scenarios.fmu.export import FMI_VERSIONS, export

_PARTS_OF = {
    "--controller": ("controller", "loop"),
    "--perception": ("loop",),
    "--seed": ("loop",),
    "--preview-ahead-m": ("controller",),
    "--preview-step-m": ("controller",),
}
"""Parts that an option is for."""
_PREVIEW_AHEAD_M, _PREVIEW_STEP_M = 8.0, 0.05


def configure(command: argparse.ArgumentParser) -> None:
    """Add the options, and the function to execute."""
    actions = command.add_subparsers(dest="action", required=True, metavar="ACTION")
    exported = actions.add_parser("export", help="write an FMU", description="Write an FMU.")
    exported.add_argument("part", choices=PARTS, help="part of the loop")
    exported.add_argument("scenario", metavar="SCENARIO", help="a name in the library, or a YAML file")
    exported.add_argument("--out", type=Path, required=True, metavar="FILE.fmu", help="the FMU to write")
    exported.add_argument("--fmi", choices=FMI_VERSIONS, default="2.0", help="version of FMI (default: 2.0)")
    exported.add_argument(
        "--code",
        choices=("python", "c"),
        default="python",
        help="python: runs foreride in the importing process; c: of the vehicle, needs no Python",
    )
    exported.add_argument("--controller", help="of controller and loop (default: mpc_preview)")
    exported.add_argument("--perception", help="of the loop (default: oracle)")
    exported.add_argument("--seed", type=int, help="of the loop (default: the scenario's)")
    exported.add_argument(
        "--preview-ahead-m",
        type=float,
        help="length of a controller's preview grid (default: 8)",
    )
    exported.add_argument("--preview-step-m", type=float, help="spacing of that grid (default: 0.05)")
    add_field_options(exported)
    exported.set_defaults(execute=execute, out_is_file=True)


def execute(arguments: argparse.Namespace) -> int:
    """Write the FMU."""
    if arguments.out.suffix != ".fmu":
        raise InputError(f"--out must name a file that ends in .fmu, got {arguments.out}")
    _require_applicable(arguments)
    scenario = load(arguments.scenario, overrides_of(arguments))
    if arguments.code == "c":
        return _export_c(arguments, scenario)
    seed = scenario.seed if arguments.seed is None else arguments.seed
    within("--seed", seed, 0, MAX_SEED)
    case = Case(scenario, arguments.controller or "mpc_preview", arguments.perception or "oracle", seed)
    preview = _preview(arguments) if arguments.part == "controller" else None
    export(arguments.out, arguments.part, case, arguments.fmi, preview)
    console.print(f"wrote {arguments.out}: FMI {arguments.fmi}, {arguments.part} of {scenario.name}")
    console.print(f"next: fmpy info {arguments.out}", highlight=False)
    return 0


def _require_applicable(arguments: argparse.Namespace) -> None:
    """Raise InputError for an option that the part takes no notice of."""
    for option, parts in _PARTS_OF.items():
        given = getattr(arguments, option.removeprefix("--").replace("-", "_")) is not None
        if given and arguments.part not in parts:
            raise InputError(f"{option} is for {' and '.join(parts)}, leave it out for the {arguments.part}")


def _export_c(arguments: argparse.Namespace, scenario: Scenario) -> int:
    if arguments.part != "vehicle":
        raise InputError(f"--code c is for the vehicle; {arguments.part} needs --code python")
    compiled = export_c(arguments.out, scenario, arguments.fmi)
    held = "sources and a binary for this platform" if compiled else "sources alone: no C compiler was found"
    console.print(f"wrote {arguments.out}: FMI {arguments.fmi}, vehicle of {scenario.name} in C, {held}")
    console.print(f"next: fmpy info {arguments.out}", highlight=False)
    return 0


def _preview(arguments: argparse.Namespace) -> dict[str, float]:
    step_m = _PREVIEW_STEP_M if arguments.preview_step_m is None else arguments.preview_step_m
    ahead_m = _PREVIEW_AHEAD_M if arguments.preview_ahead_m is None else arguments.preview_ahead_m
    if not 0.01 <= step_m <= 0.5:
        raise InputError(f"--preview-step-m must lie in 0.01 ... 0.5 m, got {step_m:g}")
    if not 0.5 <= ahead_m <= 50.0:
        raise InputError(f"--preview-ahead-m must lie in 0.5 ... 50 m, got {ahead_m:g}")
    return {"ahead_m": ahead_m, "step_m": step_m}
