"""Seated occupant of ISO 2631-1:1997, 8.2.2: seat, backrest and feet, twelve axes, one total value.

Axes are those of ISO 8855: x forward, y left, z up, rotations about them by the right-hand rule, so that
pitch is positive nose-down. The seat cushion is taken as rigid: its transmissibility is not included.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from foreride.comfort.measures import weighted_rms
from foreride.comfort.weighting import check_rate
from foreride.files.errors import InputError

Array = NDArray[np.float64]
Position = tuple[float, float, float]

_X, _Y, _Z = range(3)


class Axis(NamedTuple):
    """Evaluation axis: contact point, weighting, and multiplying factor k (m/rad for rotations)."""

    point: str
    direction: int
    rotation: bool
    weighting: str
    k: float


AXES = {
    "seat_x": Axis("seat", _X, False, "Wd", 1.0),
    "seat_y": Axis("seat", _Y, False, "Wd", 1.0),
    "seat_z": Axis("seat", _Z, False, "Wk", 1.0),
    "seat_roll": Axis("seat", _X, True, "We", 0.63),
    "seat_pitch": Axis("seat", _Y, True, "We", 0.4),
    "seat_yaw": Axis("seat", _Z, True, "We", 0.2),
    "backrest_x": Axis("backrest", _X, False, "Wc", 0.8),
    "backrest_y": Axis("backrest", _Y, False, "Wd", 0.5),
    "backrest_z": Axis("backrest", _Z, False, "Wd", 0.4),
    "feet_x": Axis("feet", _X, False, "Wk", 0.25),
    "feet_y": Axis("feet", _Y, False, "Wk", 0.25),
    "feet_z": Axis("feet", _Z, False, "Wk", 0.4),
}
"""Weightings and multiplying factors for comfort of a seated person (tables 1 and 2, 8.2.2)."""


@dataclass(frozen=True)
class SeatedPerson:
    """Contact points of a seated person: (x, y, z) from the point whose motion is given, m."""

    seat: Position
    backrest: Position
    feet: Position

    def __post_init__(self) -> None:
        for name in ("seat", "backrest", "feet"):
            if np.shape(getattr(self, name)) != (3,) or not np.all(np.isfinite(getattr(self, name))):
                raise InputError(f"{name} must be three finite values, m, got {getattr(self, name)!r}")

    @classmethod
    def at(cls, x_m: float, y_m: float = 0.0, z_m: float = 0.0) -> "SeatedPerson":
        """Person on a car seat at this point.

        Back 0.2 m behind and 0.35 m above it, feet 0.8 m ahead and 0.27 m below (the seating package of an
        ordinary car by SAE J1100).
        """
        return cls((x_m, y_m, z_m), (x_m - 0.2, y_m, z_m + 0.35), (x_m + 0.8, y_m, z_m - 0.27))


def body_motion(
    heave_acc: ArrayLike, pitch_acc: ArrayLike | None = None, roll_acc: ArrayLike | None = None
) -> tuple[Array, Array]:
    """Translation and rotation, (..., 3, n) each, of a body in heave, pitch and roll; from (..., n)."""
    heave = np.asarray(heave_acc, float)
    zero = np.zeros_like(heave)
    pitch, roll = (zero if acc is None else np.asarray(acc, float) for acc in (pitch_acc, roll_acc))
    return np.stack([zero, zero, heave], axis=-2), np.stack([roll, pitch, zero], axis=-2)


def acceleration_at(position_m: Position, acc: ArrayLike, angular_acc: ArrayLike) -> Array:
    """Acceleration (..., 3, n) of a point of a rigid body, from those of its origin and its rotation.

    a + alpha x r: small motion, without the centripetal terms of second order in the angular rates.
    """
    translation, spin = np.asarray(acc, float), np.asarray(angular_acc, float)
    components = [_component(axis, position_m, translation, spin) for axis in (_X, _Y, _Z)]
    return np.stack(components, axis=-2)


def _component(axis: int, position_m: Position, acc: Array, spin: Array) -> Array:
    """One component (..., n) of `acceleration_at`."""
    second, third = (axis + 1) % 3, (axis + 2) % 3
    turned = spin[..., second, :] * position_m[third] - spin[..., third, :] * position_m[second]
    return acc[..., axis, :] + turned


def axis_values(
    rate: float, person: SeatedPerson, acc: ArrayLike, angular_acc: ArrayLike
) -> dict[str, Array]:
    """Weighted RMS times k on each of AXES (m/s^2), for the body motion (..., 3, n); see `body_motion`.

    Raises InputError if shapes are wrong or the rate is too low.
    """
    check_rate(rate)
    translation, rotation = np.asarray(acc, float), np.asarray(angular_acc, float)
    if translation.ndim < 2 or translation.shape[-2] != 3 or rotation.shape != translation.shape:
        shapes = f"{translation.shape} and {rotation.shape}"
        raise InputError(f"acc and angular_acc must both have shape (..., 3, samples), got {shapes}")
    values = {}
    for name, axis in AXES.items():
        moving = axis.direction, getattr(person, axis.point), translation, rotation
        signal = rotation[..., axis.direction, :] if axis.rotation else _component(*moving)
        is_zero = not signal.any()  # avoids most of the filtering for a car without roll and pitch
        values[name] = (
            np.zeros(signal.shape[:-1]) if is_zero else axis.k * weighted_rms(signal, rate, axis.weighting)
        )
    return values


def total_value(values: dict[str, Array]) -> Array:
    """Overall vibration total value: root of the sum of squares of `axis_values` (m/s^2; equation 10)."""
    return np.sqrt(np.sum([np.square(value) for value in values.values()], axis=0))
