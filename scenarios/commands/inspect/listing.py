"""`foreride list`: names that the other commands and scenario files accept."""

import argparse
import inspect
from collections.abc import Callable, Iterable
from typing import Any

from foreride.comfort import METRICS
from foreride.controller.registry import CONTROLLERS, uses_preview
from foreride.files.writing.atomic import write_text
from foreride.road.features.feature import FEATURES
from foreride.scenarios.commands.console import console
from foreride.scenarios.commands.options import add_json_option
from foreride.scenarios.definition.loading import load, names
from foreride.scenarios.definition.sets import load_all, set_names
from foreride.scenarios.perceptions.registry import PERCEPTIONS
from foreride.scenarios.regression.baseline import REFERENCE, read
from foreride.scenarios.regression.tolerances import label
from foreride.scenarios.runs.write import to_json
from foreride.vehicle.dampers.damper import DAMPERS
from foreride.vehicle.load import load_vehicle, vehicle_names

Rows = Iterable[tuple[str, str]]
"""Name and meaning of each part."""


def configure(command: argparse.ArgumentParser) -> None:
    """Add the options, and the function to execute."""
    told = f"one of {', '.join(TOPICS)}"
    command.add_argument("topic", choices=TOPICS, metavar="TOPIC", help=told)
    add_json_option(command, "write names and meanings as JSON")
    command.set_defaults(execute=execute)


def execute(arguments: argparse.Namespace) -> int:
    """Print one line for each name of the topic."""
    rows = list(TOPICS[arguments.topic]())
    width = max(len(name) for name, _ in rows)
    for name, meaning in rows:
        console.print(f"{name:{width}}  {meaning}", highlight=False, soft_wrap=True)
    if arguments.json:
        document = {"schema": 1, arguments.topic: [{"name": name, "meaning": text} for name, text in rows]}
        write_text(arguments.json, to_json(document) + "\n")
    return 0


def _scenarios() -> Rows:
    for name in names():
        yield name, load(name).title


def _sets() -> Rows:
    for name in set_names():
        yield name, f"{len(load_all([name]))} scenarios"


def _vehicles() -> Rows:
    for name in vehicle_names():
        car = load_vehicle(name)
        yield (
            name,
            f"{car.kind.replace('_', ' ')}, sprung mass {car.generalised_mass[0]:g} kg",
        )


def _controllers() -> Rows:
    for name, entry in CONTROLLERS.parts().items():
        preview = ", uses the preview" if uses_preview(name) else ""
        yield name, f"{entry.summary}{preview}"


def _perceptions() -> Rows:
    return ((name, entry.label) for name, entry in PERCEPTIONS.parts().items())


def _metrics() -> Rows:
    return ((name, metric.definition) for name, metric in METRICS.parts().items())


def _cases() -> Rows:
    """Cases of foreride's own regression baseline."""
    for entry in read(REFERENCE).entries:
        yield (
            label(entry.case(REFERENCE.parent), entry.override_texts),
            f"Wk RMS {entry.metrics['wk_rms']:.3f} m/s²",
        )


def _classes(parts: dict[str, Any]) -> Rows:
    return ((name, inspect.cleandoc(cls.__doc__ or "").partition("\n")[0]) for name, cls in parts.items())


TOPICS: dict[str, Callable[[], Rows]] = {
    "scenarios": _scenarios,
    "sets": _sets,
    "vehicles": _vehicles,
    "controllers": _controllers,
    "perceptions": _perceptions,
    "metrics": _metrics,
    "cases": _cases,
    "dampers": lambda: _classes(DAMPERS.parts()),
    "features": lambda: _classes(FEATURES.parts()),
}
"""What is listed, by the word on the command line."""
