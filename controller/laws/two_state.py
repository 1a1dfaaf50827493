"""Two-state (on–off) semi-active laws: the damper is either soft or hard.

skyhook2: hard while the damper opposes the body velocity (Karnopp, Crosby & Harwood, J. Eng. Ind. 96, 1974).
groundhook: hard while it opposes the wheel velocity (Valášek et al., Vehicle Syst. Dyn. 27, 1997).
add: hard while it opposes the body acceleration (acceleration-driven damping: Savaresi, Silani & Bittanti,
J. Dyn. Syst. Meas. Control 127, 2005).
sh_add: skyhook2 below a crossover frequency, add above it, selected without a filter by the ratio of body
acceleration to velocity (Savaresi & Spelta, J. Dyn. Syst. Meas. Control 129, 2007).
"""

from collections.abc import Callable
from math import tau

import numpy as np

from foreride.controller.command_limits import DampingLimits
from foreride.controller.interface import BaseController, Estimate, Timing
from foreride.controller.laws.corner_motion import corner_motion
from foreride.controller.settings import ShAddSettings, TwoStateSettings
from foreride.preview.road_preview import RoadPreview
from foreride.vehicle.equations import FLOATS, body_acceleration
from foreride.vehicle.load import Car

OpposedMotion = Callable[[Car, Estimate], np.ndarray]
"""Motion of each corner (wheels,) that the damper should oppose; only its sign matters."""


def skyhook2(vehicle: Car, estimate: Estimate) -> np.ndarray:
    """Body velocity above each wheel, m/s."""
    return corner_motion(vehicle, estimate.x).body


def groundhook(vehicle: Car, estimate: Estimate) -> np.ndarray:
    """Downward velocity of each wheel, m/s."""
    return -corner_motion(vehicle, estimate.x).wheel


def add(vehicle: Car, estimate: Estimate) -> np.ndarray:
    """Body acceleration above each wheel, m/s²."""
    height, velocity = estimate.road_height.tolist(), estimate.road_velocity.tolist()
    return np.array(body_acceleration(vehicle, estimate.x.tolist(), height, velocity, xp=FLOATS))


class TwoState(BaseController):
    """Hard if `law` and suspension velocity have the same sign, soft otherwise."""

    def __init__(
        self,
        vehicle: Car,
        settings: TwoStateSettings | None = None,
        timing: Timing | None = None,
        *,
        law: OpposedMotion,
    ):
        settings = settings or TwoStateSettings()
        limits = DampingLimits.of(vehicle)
        self._vehicle, self._law = vehicle, law
        self._high, self._low = limits.clip(settings.hard_ns_m), limits.clip(settings.soft_ns_m)

    def step(self, estimate: Estimate, preview: RoadPreview | None) -> np.ndarray:
        """Return the damping (wheels,), N·s/m."""
        relative = corner_motion(self._vehicle, estimate.x).relative
        hard = self._law(self._vehicle, estimate) * relative > 0.0
        return np.where(hard, self._high, self._low)


def sh_add(vehicle: Car, settings: ShAddSettings | None = None, timing: Timing | None = None) -> TwoState:
    """Mixed skyhook–ADD law of Savaresi & Spelta with crossover frequency and levels from `settings`."""
    settings = settings or ShAddSettings()
    crossover = tau * settings.crossover_hz

    def mixed(vehicle: Car, estimate: Estimate) -> np.ndarray:
        velocity, acceleration = skyhook2(vehicle, estimate), add(vehicle, estimate)
        slow = acceleration**2 <= (crossover * velocity) ** 2
        return np.where(slow, velocity, acceleration)

    return TwoState(vehicle, TwoStateSettings(settings.hard_ns_m, settings.soft_ns_m), timing, law=mixed)
