"""Energy audit of a run: passivity of the dampers, energy and power of the actuators."""

import numpy as np
from numpy.typing import NDArray

from foreride.vehicle.clock import RATE_HZ
from foreride.vehicle.dampers import actuator
from foreride.vehicle.load import Car

Array = NDArray[np.float64]
_ROUNDING = 1e-9


def energy_audit(
    parameters: Car, damper_force: Array, rattle_velocity: Array, damping: Array, actuator_force: Array
) -> dict[str, float]:
    """Audit a recorded drive from its signals at every tick, (wheels, n), as `vehicle.state` names them.

    damper_produced: energy that dampers supplied to the car, J; 0 for a passive element. damping_outside:
    time during which any damper's setting lay outside its range, s. With actuators also actuator_energy:
    energy delivered, J; actuator_recovered: energy absorbed, J; actuator_power, actuator_power_peak: mean
    over the run and maximum of the total power delivered, W.
    """
    damper_power = damper_force * rattle_velocity
    low, high = (
        np.array([[getattr(corner, name)] for corner in parameters.corners])
        for name in ("damping_min_ns_m", "damping_max_ns_m")
    )
    slack = _ROUNDING * high
    outside = (damping < low - slack) | (damping > high + slack)
    audit = {
        "damper_produced": float(np.maximum(damper_power, 0.0).sum() / RATE_HZ),
        "damping_outside": float(outside.any(axis=0).sum() / RATE_HZ),
    }
    if parameters.corners[0].actuator is None:
        return audit
    power = actuator.power(actuator_force, rattle_velocity)
    delivered, absorbed = actuator.work(power, RATE_HZ)
    total = np.maximum(power, 0.0).sum(axis=0)
    return audit | {
        "actuator_energy": delivered,
        "actuator_recovered": absorbed,
        "actuator_power": float(total.mean()),
        "actuator_power_peak": float(total.max()),
    }
