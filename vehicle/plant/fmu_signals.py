"""Signals that a car given as an FMU takes and gives, and the vehicle signals that follow from them."""

from dataclasses import fields, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from foreride.files.fmi.foreign import Quantity
from foreride.vehicle.equations import input_size, point_motion, rest_state
from foreride.vehicle.load import Car
from foreride.vehicle.state import VehicleState, signal_unit
from foreride.vehicle.state_layout import state_layout

Array = NDArray[np.float64]
_DERIVED = ("rattle_m", "rattle_velocity", "body_acc", "seat_acc")
_FORCES = ("damping", "damper_force", "actuator_force", "stop_force", "static_tyre_force")
_MOTIONS = ("heave_m", "pitch_rad", "roll_rad")
_RATES = ("heave_velocity", "pitch_rate", "roll_rate")
_ACCELERATIONS = ("cg_acc", "pitch_acc", "roll_acc")


def fmu_quantities(car: Car) -> list[Quantity]:
    """Inputs and outputs of a car as an FMU, in the order of `files.fmi.foreign`."""
    wheels, bodies = range(car.wheels), len(car.generalised_mass)
    needed = [name for group in (_MOTIONS, _RATES, _ACCELERATIONS) for name in group[:bodies]]
    needed += [f"{name}_{i}" for name in ("wheel_z", "wheel_v", "wheel_acc", "tyre_force") for i in wheels]
    offered = [f"{name}_{i}" for name in (*_FORCES, *_DERIVED[:3]) for i in wheels]
    offered += [f"seat_acc_{i}" for i in range(len(car.seat_kinematic_rows))]
    outputs = [Quantity(name, signal_unit(name), "output", True) for name in needed]
    return [*_inputs(car), *outputs, *(Quantity(name, signal_unit(name), "output") for name in offered)]


def _inputs(car: Car) -> list[Quantity]:
    wheels, forces = range(car.wheels), range(input_size(car) - car.wheels)
    return [
        *(Quantity(f"damping_command_{i}", "N·s/m", "input", True) for i in wheels),
        *(Quantity(f"force_command_{i}", "N", "input", True) for i in forces),
        *(Quantity(f"road_height_{i}", "m", "input", True) for i in wheels),
        *(Quantity(f"road_velocity_{i}", "m/s", "input") for i in wheels),
        *(Quantity(f"road_acceleration_{i}", "m/s²", "input") for i in wheels),
        Quantity("speed_m_s", "m/s", "input"),
        Quantity("forward_acc", "m/s²", "input"),
    ]


def motion_state(car: Car, given: dict[str, Any], command: Array) -> Array:
    """State of `vehicle.equations` from an FMU's outputs; dampers without a setting have the command's.

    Actuator forces that are not given, and the dampers' internal states, are zero.
    """
    layout, wheels = state_layout(car), range(car.wheels)
    bodies = len(car.generalised_mass)
    shape = np.shape(given["heave_m"])
    x = np.zeros((len(rest_state(car)), *shape))
    x[layout.body] = [given[name] for name in _MOTIONS[:bodies]]
    x[layout.body_velocity] = [given[name] for name in _RATES[:bodies]]
    x[layout.wheel] = [given[f"wheel_z_{i}"] for i in wheels]
    x[layout.wheel_velocity] = [given[f"wheel_v_{i}"] for i in wheels]
    x[layout.damping] = [given.get(f"damping_{i}", command[i]) for i in wheels]
    if layout.force.stop > layout.force.start:
        x[layout.force] = [given.get(f"actuator_force_{i}", np.zeros(shape)) for i in wheels]
    return x


def with_outputs(car: Car, known: VehicleState, given: dict[str, Any]) -> VehicleState:
    """Signals that the car's known equations give for an FMU's motion, replaced by the FMU's outputs.

    Accelerations of points on the body that it does not give follow from those of the body.
    """
    body = [given[name] for name in _ACCELERATIONS[: len(car.generalised_mass)]]
    rows = {"body_acc": [corner.kinematic_row for corner in car.corners], "seat_acc": car.seat_kinematic_rows}
    changed: dict[str, Any] = {
        name: np.array([point_motion(row, body) for row in kinematic]) for name, kinematic in rows.items()
    }
    for field in fields(known):
        if field.name in given:
            changed[field.name] = given[field.name]
        elif f"{field.name}_0" in given:
            parts = [given.get(f"{field.name}_{i}") for i in range(len(getattr(known, field.name)))]
            if all(part is not None for part in parts):
                changed[field.name] = np.array(parts)
    return replace(known, **changed)
