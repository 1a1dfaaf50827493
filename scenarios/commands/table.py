"""`foreride table`: the result tables of README and documentation, each with its own options."""

import argparse
import importlib

TABLES = {
    "actuators": "semi-active, slow-active and fully active suspensions on random roads, and their energy",
    "braking": "stopping distances on random rough roads",
    "budget": "cost of each source of error, as a share of the gain of perfect preview",
    "degraded": "cost of errors of the preview, with an erroneous oracle",
    "faults": "cost of failing sensors, previews and solvers under the supervisor",
    "grades": "controllers on grades and banks, relative to the level road",
    "observer": "errors of the observer against the covariances that it claims",
    "rivals": "all controllers on the reporting set",
    "proving_ground": "proving-ground bumps of Theunissen et al.",
    "random_roads": "controllers on random roads that nothing was tuned on",
    "robustness": "controllers on cars, valves and sensors that differ from what they know",
    "speed": "speed planned with the damper on random roads: comfort against time lost",
    "sensors": "what each sensor of the road ahead is worth on random roads",
    "wrong_previews": "random drives with wrong previews, against the supervisor's gate",
}
_ROOMS = dict.fromkeys(("actuators", "braking", "speed"), "chassis.")
"""Rooms of `scenarios.tables` of the tables that do not lie in it."""


def configure(command: argparse.ArgumentParser) -> None:
    """Add the table's name; the options after it belong to the table's module."""
    command.description = "; ".join(f"{name}: {text}" for name, text in TABLES.items())
    command.add_argument("name", choices=TABLES)
    command.add_argument("rest", nargs=argparse.REMAINDER, metavar="...", help="options; `--help` lists them")
    command.set_defaults(execute=execute)


def execute(arguments: argparse.Namespace) -> int:
    """Simulate and print the table."""
    module = f"{_ROOMS.get(arguments.name, '')}{arguments.name}"
    importlib.import_module(f"foreride.scenarios.tables.{module}").main(arguments.rest)
    return 0
