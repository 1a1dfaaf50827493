"""Observer errors: deviation of the estimates from the simulated state over a drive."""

from array import array

import numpy as np

from foreride.controller.interface import Estimate
from foreride.scenarios.definition.clock import TICKS_PER_SECOND
from foreride.scenarios.simulation.recorded_signals import RecordedSignals
from foreride.vehicle import equations
from foreride.vehicle.load import Car


class EstimateRecord:
    """Estimates of a drive, a row of numbers each: time, state, road heights and contacts of the wheels."""

    def __init__(self) -> None:
        self._numbers, self._count = array("d"), 0

    def __len__(self) -> int:
        return self._count

    def add(self, estimate: Estimate) -> None:
        """Append an estimate."""
        self._numbers.append(estimate.time_s)
        for part in (estimate.x, estimate.road_height, estimate.contact.astype(float)):
            self._numbers.frombytes(part.tobytes())
        self._count += 1

    def columns(self) -> np.ndarray:
        """The numbers, (1 + states + 2 · wheels, estimates)."""
        return np.array(self._numbers).reshape(self._count, -1).T


def observer_errors(car: Car, estimates: EstimateRecord, signals: RecordedSignals) -> dict[str, float]:
    """RMS error of each state over the drive, and over the wheels for per-wheel states; {} without estimates.

    Heights are compared relative to one another, because the observer's frame follows the road: rattle (body
    to wheel) and tyre deflection (wheel to road, while the wheel touches it).
    """
    if not estimates:
        return {}
    times_s, *_ = columns = estimates.columns()
    estimated, road, in_contact = np.split(columns[1:], [-2 * car.wheels, -car.wheels])
    simulated, simulated_road, tyre_force = signals.whole(
        lambda part: {"x": part.x, "road": part.road_height, "force": part.tyre_force},
        np.rint(times_s * TICKS_PER_SECOND).astype(np.int64),
    ).values()
    estimated_motion, simulated_motion = equations.motion(car, estimated), equations.motion(car, simulated)
    travel, rate = (
        a - b for a, b in zip(equations.rattle(car, estimated), equations.rattle(car, simulated), strict=True)
    )
    estimated_deflection = road - np.array(estimated_motion.wheel)
    deflection = estimated_deflection - (simulated_road - np.array(simulated_motion.wheel))
    contact = (in_contact > 0.0) & (tyre_force > 0.0)
    motions = ("heave_velocity", "pitch_rate", "roll_rate")[: len(car.generalised_mass)]
    errors = {
        "rattle_m": travel,
        "rattle_velocity": rate,
        "wheel_velocity": np.array(estimated_motion.wheel_velocity)
        - np.array(simulated_motion.wheel_velocity),
        "tyre_deflection_m": deflection[contact],
        "damping_ns_m": np.array(estimated_motion.damping) - np.array(simulated_motion.damping),
    } | {
        name: a - b
        for name, a, b in zip(
            motions, estimated_motion.body_velocity, simulated_motion.body_velocity, strict=True
        )
    }
    return {name: float(np.sqrt(np.mean(error**2))) if error.size else 0.0 for name, error in errors.items()}
