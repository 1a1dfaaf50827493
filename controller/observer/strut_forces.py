"""Forces of a car's struts on its body: `vehicle.equations.forces`, recorded once by CasADi.

The Python of the equations would cost more than the rest of the observer. The forces of dampers that are not
ideal may be a user's: they are not recorded but evaluated with floats.
"""

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from foreride.vehicle.equations import evaluate_forces, motion, state_size
from foreride.vehicle.load import Car
from foreride.vehicle.plant.instant import damper_forces, has_ideal_dampers
from foreride.vehicle.plant.recorded_function import RecordedFunction

if TYPE_CHECKING:  # CasADi is slow to import
    import casadi


class StrutForces:
    """Forces of spring, damper, stop and actuator on the body at each wheel, up, N."""

    def __init__(self, car: Car) -> None:
        self._car, self._recorded = car, RecordedFunction(_recorded(car))
        self._dampers = None if has_ideal_dampers(car) else slice(state_size(car), -1)

    def __call__(self, x: np.ndarray, strength: float) -> np.ndarray:
        """Forces (wheels,) in a state (states,), with the dampers' ones times `strength`.

        The next call overwrites them.
        """
        recorded = self._recorded
        recorded.inputs[: len(x)], recorded.inputs[-1] = x, strength
        if self._dampers:
            recorded.inputs[self._dampers] = damper_forces(self._car, x.tolist())
        recorded.evaluate()
        return recorded.outputs


@lru_cache(maxsize=32)
def _recorded(car: Car) -> "casadi.Function":
    """The function of the state, the forces of dampers that are not ideal, and the dampers' strength."""
    import casadi

    states, wheels = state_size(car), car.wheels
    given = casadi.SX.sym("given", states + wheels * (not has_ideal_dampers(car)) + 1)
    x, damper, (strength,) = np.split(np.array(casadi.vertsplit(given), dtype=object), [states, -1])
    level = [casadi.SX(0.0)] * wheels
    forces = evaluate_forces(car, motion(car, list(x)), level, level, casadi, list(damper) or None)[2]
    parts = zip(forces.spring, forces.damper, forces.stop, forces.actuator, strict=True)
    totals = [spring + strength * damper + stop + own for spring, damper, stop, own in parts]
    return casadi.Function("struts", [given], [casadi.vertcat(*totals)])
