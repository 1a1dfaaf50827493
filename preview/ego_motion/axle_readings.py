"""Sensor readings of the wheels as means over the axles, and the height of the body over the road in them."""

from typing import NamedTuple, Protocol

import numpy as np

from foreride.files.errors import InputError


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


class BodyReading(NamedTuple):
    """Acceleration of the body at the centre of gravity (m/s²), and deflections.

    deflection_m: (axles,) height of the body over the road less that at rest, front first.
    wheel_deflection_m: (wheels,) the same at each wheel.
    """

    acceleration: float
    deflection_m: np.ndarray
    wheel_deflection_m: np.ndarray


class AxleReadings:
    """Readings over the axles, which are linear in those of the wheels.

    axle_x_m: position of each wheel relative to the centre of gravity; wheels at the same place share an
    axle, which moves by their mean. tyre_compliance: as in `preview.vehicle_facts`. positions_m: of the
    axles, front first.
    """

    def __init__(self, axle_x_m: tuple[float, ...], tyre_compliance: np.ndarray) -> None:
        axles = sorted(set(axle_x_m), reverse=True)
        if len(axles) not in (1, 2):
            raise InputError(f"axle_x_m must name 1 or 2 axles, got {len(axles)}")
        self.positions_m, self._wheels = np.array(axles, dtype=float), len(axle_x_m)
        shares = np.array([[x == axle for x in axle_x_m] for axle in axles], dtype=float)
        shares /= shares.sum(axis=1, keepdims=True)
        # Newton for wheels and body above the tyres: k (road - wheel) = m_u a_u + m_s a_s.
        deflection = np.hstack([-tyre_compliance, np.eye(self._wheels)])
        acceleration = np.zeros(3 * self._wheels)
        acceleration[: self._wheels] = _at_centre(self.positions_m) @ shares
        self._rows = np.vstack([deflection, shares @ deflection, acceleration])

    def of(self, measurement: Measurement) -> BodyReading:
        """Reading of the body in a measurement."""
        read = np.concatenate([measurement.body_acc, measurement.wheel_acc, measurement.rattle_m])
        values = self._rows @ read
        return BodyReading(float(values[-1]), values[self._wheels : -1], values[: self._wheels])


def _at_centre(axle_x_m: np.ndarray) -> np.ndarray:
    """Weights (axles,) that interpolate a quantity over the axles to the centre of gravity."""
    if len(axle_x_m) == 1:
        return np.ones(1)
    front, rear = axle_x_m
    return np.array([-rear, front]) / (front - rear)
