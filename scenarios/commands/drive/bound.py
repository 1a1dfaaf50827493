"""`foreride bound`: lower bound of the objective on a scenario, for any controller."""

import argparse
from dataclasses import replace

from foreride.controller.registry import CLAIRVOYANT
from foreride.files.writing.atomic import write_text
from foreride.scenarios.bound.headroom import headroom
from foreride.scenarios.bound.optimum_cache import bound
from foreride.scenarios.bound.simulate_case import simulate_case
from foreride.scenarios.cases import Case
from foreride.scenarios.commands.console import console
from foreride.scenarios.commands.options import add_field_options, add_json_option, overrides_of
from foreride.scenarios.definition.loading import load
from foreride.scenarios.definition.schema import Scenario
from foreride.scenarios.runs.record import vehicle_name
from foreride.scenarios.runs.write import environment, scenario_hash, to_json
from foreride.vehicle.dampers.actuator import FullyActive, SlowActive

ACTUATORS = {"none": None, "slow_active": SlowActive(), "fully_active": FullyActive()}


def configure(command: argparse.ArgumentParser) -> None:
    """Add the options, and the function to execute."""
    command.add_argument("scenario", metavar="SCENARIO", help="a name in the library, or a YAML file")
    beside = "actuators in parallel with the dampers (default: those of the scenario's car)"
    command.add_argument("--actuator", choices=tuple(ACTUATORS), help=beside)
    add_field_options(command)
    add_json_option(command)
    command.set_defaults(execute=execute)


def execute(arguments: argparse.Namespace) -> int:
    """Compute the scenario's optimum, or take it from the cache, and replay it on the plant."""
    scenario = load(arguments.scenario, overrides_of(arguments))
    if arguments.actuator:
        scenario = with_actuator(scenario, arguments.actuator)
    with console.status(f"searching the optimum of {scenario.name}, a minute or a few"):
        optimum = bound(scenario)
        metrics = simulate_case(Case(scenario, CLAIRVOYANT, "none", scenario.seed)).metrics
        headrooms = headroom(scenario, optimum)
    console.print(
        f"{scenario.name}, {scenario.vehicle.model}: J {metrics['objective']:.4f} (m/s²)², "
        f"{metrics['objective'] / headrooms['passive_objective']:.3f} of passive; "
        f"Wk RMS {metrics['wk_rms']:.3f} m/s²; starts end within {100 * optimum.gap:.2f} %"
    )
    if arguments.json:
        numbers = {
            "schema": 1,
            "scenario": scenario.name,
            "scenario_hash": scenario_hash(scenario),
            "vehicle": vehicle_name(scenario),
            **headrooms,
            "objective": metrics["objective"],
            "wk_rms": metrics["wk_rms"],
            "starts": optimum.objectives,
            "metrics": metrics,
            "manifest": environment(),
        }
        write_text(arguments.json, to_json(numbers) + "\n")
    return 0


def with_actuator(scenario: Scenario, actuator: str) -> Scenario:
    """Return the scenario with another actuator in its car: none, slow_active or fully_active."""
    parameters = replace(scenario.vehicle.parameters, actuator=ACTUATORS[actuator])
    return replace(scenario, vehicle=replace(scenario.vehicle, parameters=parameters))
