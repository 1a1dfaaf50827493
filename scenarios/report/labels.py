"""Names of runs, wheels and seats in figures, the report and the film."""

from foreride.files.errors import printable
from foreride.scenarios.runs.record import vehicle_name
from foreride.scenarios.simulation.simulate import Run
from foreride.vehicle.load import Car

_WHEELS = {1: ("",), 2: ("front", "rear"), 4: ("front left", "front right", "rear left", "rear right")}


def variant_label(controller: str, perception: str) -> str:
    """Name of a controller with its perception, if it has one."""
    name = printable(controller.rpartition(":")[2])
    return name if perception == "none" else f"{name} ({perception})"


def label_of(run: Run) -> str:
    """Name of a run."""
    return variant_label(run.case.controller, run.case.perception)


def drive_of(run: Run) -> tuple[str, str]:
    """Names of the scenario and the vehicle of a run, as in the rows of a comparison."""
    return run.case.scenario.name, vehicle_name(run.case.scenario)


def wheel_label(car: Car, wheel: int, noun: str) -> str:
    """`noun` at a wheel, such as `front damper`; a quarter car has just one."""
    return f"{_WHEELS[car.wheels][wheel]} {noun}".strip()


def acceleration_label(car: Car) -> str:
    """Name of the signal `seat_acc_0`."""
    return "body acceleration" if car.wheels == 1 else "acceleration at the front seat"


def plain(text: str) -> str:
    """Text escaped for Matplotlib, which takes dollar signs for formulas."""
    return printable(text).replace("$", r"\$")
