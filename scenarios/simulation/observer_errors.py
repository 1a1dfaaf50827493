"""Observer errors: deviation of the estimates from the simulated state over a drive."""

from collections.abc import Sequence

import numpy as np

from foreride.controller.interface import Estimate
from foreride.scenarios.definition.clock import ticks
from foreride.vehicle import equations
from foreride.vehicle.load import Car
from foreride.vehicle.state import VehicleState


def observer_errors(car: Car, estimates: Sequence[Estimate], record: VehicleState) -> dict[str, float]:
    """RMS error of each state over the drive, and over the wheels for per-wheel states; {} without estimates.

    Heights are compared relative to one another, because the observer's frame follows the road: rattle (body
    to wheel) and tyre deflection (wheel to road, while the wheel touches it).
    """
    if not estimates:
        return {}
    when = [ticks(estimate.time_s) for estimate in estimates]
    ours, true = np.array([estimate.x for estimate in estimates]).T, record.x[:, when]
    mine, real = equations.motion(car, ours), equations.motion(car, true)
    travel, rate = (
        a - b for a, b in zip(equations.rattle(car, ours), equations.rattle(car, true), strict=True)
    )
    felt = np.array([estimate.road_height for estimate in estimates]).T - np.array(mine.wheel)
    deflection = felt - (record.road_height[:, when] - np.array(real.wheel))
    contact = np.array([estimate.contact for estimate in estimates]).T & (record.tyre_force[:, when] > 0.0)
    motions = ("heave_velocity", "pitch_rate", "roll_rate")[: len(car.generalised_mass)]
    errors = {
        "rattle_m": travel,
        "rattle_velocity": rate,
        "wheel_velocity": np.array(mine.wheel_velocity) - np.array(real.wheel_velocity),
        "tyre_deflection_m": deflection[contact],
        "damping_ns_m": np.array(mine.damping) - np.array(real.damping),
    } | {name: a - b for name, a, b in zip(motions, mine.body_velocity, real.body_velocity, strict=True)}
    return {name: float(np.sqrt(np.mean(error**2))) if error.size else 0.0 for name, error in errors.items()}
