"""Vehicle facts: what the estimator of the road must know of the car beside the positions of its wheels."""

from dataclasses import dataclass, field

import numpy as np

from foreride.road.tyre.tyre import Tyre

_WHEEL_HOP_HZ, _BODY_HOP_HZ = 10.8, 3.5  # natural frequencies of wheel and body on the tyre of a compact car
_STATIC_DEFLECTION_M = 0.02


@dataclass(frozen=True, eq=False)
class VehicleFacts:
    """Tyres of the car, and their deflection under its masses.

    tyre_compliance: (wheels, 2 wheels) deflection beyond the static one per acceleration of the body above
    the wheels, then of the wheels, m per m/s², positive: road nearer to the wheel. static_deflection_m: of
    the front tyres at rest, beyond which a wheel leaves the road. tyre: radius and enveloping.
    """

    tyre_compliance: np.ndarray
    static_deflection_m: float = _STATIC_DEFLECTION_M
    tyre: Tyre = field(default_factory=Tyre)

    @classmethod
    def typical(cls, wheels: int) -> "VehicleFacts":
        """Facts of a compact car, whose corners move independently."""
        body, wheel = (np.eye(wheels) / (2.0 * np.pi * hop) ** 2 for hop in (_BODY_HOP_HZ, _WHEEL_HOP_HZ))
        return cls(np.hstack([body, wheel]))
