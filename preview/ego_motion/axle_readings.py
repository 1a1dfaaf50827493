"""Sensor readings of the wheels as means over the axles, and the height of the body over the road in them."""

from typing import Any, Protocol

import numpy as np

from foreride.files.errors import InputError
from foreride.files.jit import njit


class Measurement(Protocol):
    """Sensor readings of the car at one moment; one entry per wheel, front first."""

    @property
    def body_acc(self) -> np.ndarray:
        """Vertical acceleration of the body over each wheel, without gravity, m/s²."""

    @property
    def wheel_acc(self) -> np.ndarray:
        """Vertical acceleration of each wheel, m/s²."""

    @property
    def rattle_m(self) -> np.ndarray:
        """Rattle space: body minus wheel height, m, deviation from rest."""

    @property
    def pitch_rate(self) -> float:
        """Pitch rate, positive nose-down, rad/s."""

    @property
    def roll_rate(self) -> float:
        """Rate of roll, positive left side up, rad/s; 0 for a car without roll."""

    @property
    def speed_m_s(self) -> float:
        """Speed along the road, m/s."""


class AxleReadings:
    """Readings over the axles, overwritten by each measurement.

    axle_x_m: position of each wheel relative to the centre of gravity; wheels at the same place share an
    axle, which moves by their mean. tyre_compliance: as in `preview.vehicle_facts`.

    positions_m: of the axles, front first. wheel_deflection_m (wheels,), deflection_m (axles,): height of the
    body over the road less its value at rest.
    """

    def __init__(self, axle_x_m: tuple[float, ...], tyre_compliance: np.ndarray) -> None:
        axles = sorted(set(axle_x_m), reverse=True)
        if len(axles) not in (1, 2):
            raise InputError(f"axle_x_m must name 1 or 2 axles, got {len(axles)}")
        self.positions_m = np.array(axles, dtype=float)
        self._axle_of_wheel = np.array([axles.index(x) for x in axle_x_m])
        self._compliance = np.ascontiguousarray(tyre_compliance)
        self.wheel_deflection_m, self.deflection_m = np.zeros(len(axle_x_m)), np.zeros(len(axles))

    def take(self, measurement: Measurement) -> tuple[float, float]:
        """Acceleration of the body at the centre of gravity, and the greatest one of a wheel, m/s²."""
        read = measurement.body_acc, measurement.wheel_acc, measurement.rattle_m
        car = self._compliance, self._axle_of_wheel, self.positions_m
        return _take(*read, *car, self.wheel_deflection_m, self.deflection_m)  # type: ignore[no-any-return]


@njit
def _take(
    body_acc: Any,
    wheel_acc: Any,
    rattle_m: Any,
    compliance: Any,
    axle_of_wheel: Any,
    axle_x_m: Any,
    wheel_deflection: Any,
    deflection: Any,
) -> tuple[float, float]:
    """Newton for wheels and body above the tyres: k (road - wheel) = m_u a_u + m_s a_s."""
    wheels, greatest = len(rattle_m), 0.0
    for wheel in range(wheels):
        tyre_m = 0.0
        for other in range(wheels):
            tyre_m += compliance[wheel, other] * body_acc[other]
        for other in range(wheels):
            tyre_m += compliance[wheel, wheels + other] * wheel_acc[other]
        wheel_deflection[wheel] = rattle_m[wheel] - tyre_m
        greatest = max(greatest, abs(wheel_acc[wheel]))
    for axle in range(len(axle_x_m)):
        deflection[axle] = _mean(wheel_deflection, axle_of_wheel, axle)
    front = _mean(body_acc, axle_of_wheel, 0)
    if len(axle_x_m) == 1:
        return front, greatest
    rear = _mean(body_acc, axle_of_wheel, 1)
    return (axle_x_m[0] * rear - axle_x_m[1] * front) / (axle_x_m[0] - axle_x_m[1]), greatest


@njit
def _mean(values: Any, axle_of_wheel: Any, axle: int) -> float:
    """Mean over the wheels of an axle."""
    total, count = 0.0, 0
    for wheel in range(len(values)):
        if axle_of_wheel[wheel] == axle:
            total += values[wheel]
            count += 1
    return total / count
