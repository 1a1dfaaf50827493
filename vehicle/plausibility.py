"""Plausibility of vehicles: parameters that are valid one by one, but not together.

`require_plausible` refuses what cannot be a road vehicle, from model cars to trucks, or cannot be integrated;
`doubts` says what no passenger car has, and lets it drive.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from foreride.files.errors import InputError
from foreride.files.reading.units import unit_hint
from foreride.vehicle.corner import GRAVITY_M_S2, Corner

Array = NDArray[np.float64]
MAX_EIGENVALUE_1_S = 500.0
"""Largest eigenvalue that the prediction models' Runge–Kutta steps of up to 5 ms can integrate, 1/s."""
MIN_BODY_FREQUENCY_HZ, MAX_BODY_FREQUENCY_HZ = 0.05, 20.0
SHORTEST_SPRING_M, MAX_SPRING_DEFLECTION_M = 1e-3, 3.0


@dataclass(frozen=True)
class _Quantity:
    """Physical consequence of a field's value: refused outside `possible`, doubted outside `usual`.

    effect: what the value does, with a gap for the number; of: the consequence as a function of the value.
    """

    field: str
    value: float
    unit: str
    effect: str
    effect_unit: str
    of: Callable[[float], float]
    possible: tuple[float, float]
    usual: tuple[float, float]

    def text(self, limits: tuple[float, float]) -> str:
        """Field, value, consequence, what is allowed, and the unit that is likely meant."""
        low, high = limits

        def fits(value: float) -> bool:
            return low <= self.of(value) <= high

        consequence = self.effect.format(f"{self.of(self.value):.4g} {self.effect_unit}".rstrip())
        allowed = f"{low:g} ... {high:g} {self.effect_unit}".rstrip()
        hint = unit_hint(self.value, self.unit, fits)
        return f"{self.field} = {self.value:g} {self.unit} {consequence}, {{}} {allowed}{hint}"

    def outside(self, limits: tuple[float, float]) -> bool:
        """Whether the consequence lies outside the limits."""
        return not limits[0] <= self.of(self.value) <= limits[1]


def require_plausible(car: Any) -> None:
    """Raise InputError for a car whose springs, dampers and masses do not match.

    Wide limits, from model cars to trucks: bounded static deflection of tyres and springs, lowest natural
    frequency within bounds, and no eigenvalue too fast to be integrated.
    """
    for quantity in _quantities(car):
        if quantity.outside(quantity.possible):
            raise InputError(quantity.text(quantity.possible).format("must be"))
    stiffness, damping, mass = _matrices(car)
    slowest = _frequencies_hz(stiffness, mass)[0]
    _limit(
        "spring_n_m", "let the body bounce with", slowest, MIN_BODY_FREQUENCY_HZ, MAX_BODY_FREQUENCY_HZ, "Hz"
    )
    size = len(mass)
    system = np.block(
        [
            [np.zeros((size, size)), np.eye(size)],
            [-stiffness / mass[:, None], -damping / mass[:, None]],
        ]
    )
    fastest_undamped = 2 * np.pi * float(_frequencies_hz(stiffness, mass)[-1])
    fastest = max(float(np.abs(np.linalg.eigvals(system)).max()), fastest_undamped)
    names = "unsprung_mass_kg, tyre_n_m and damping_max_ns_m"
    _limit(names, "give motions of", fastest, 0.0, MAX_EIGENVALUE_1_S, "1/s")


def doubts(car: Any) -> tuple[str, ...]:
    """Properties of the car that no passenger car has, each in one line."""
    found = [
        quantity.text(quantity.usual).format("usual are")
        for quantity in _quantities(car)
        if quantity.outside(quantity.usual)
    ]
    stiffness, _, mass = _matrices(car)
    frequencies, bodies = _frequencies_hz(stiffness, mass), len(car.generalised_mass)
    for name, values, low, high in (
        ("body", frequencies[:bodies], 0.5, 5.0),
        ("wheels", frequencies[bodies:], 5.0, 25.0),
    ):
        if values[0] < low or values[-1] > high:
            found.append(
                f"{name} with natural frequencies of {values[0]:.3g} ... {values[-1]:.3g} Hz, "
                f"usual are {low:g} ... {high:g} Hz"
            )
    return tuple(found)


def _quantities(car: Any) -> Iterator[_Quantity]:
    body_name = "sprung_mass_kg" if car.wheels == 1 else "body_mass_kg"
    for i, corner in enumerate(car.corners):
        yield from _loads(car, corner, i, body_name)
        yield from _suspension(car, corner, "" if car.wheels == 1 else f"[{i * 2 // car.wheels}]")


def _loads(car: Any, corner: Corner, wheel: int, body_name: str) -> Iterator[_Quantity]:
    body, unsprung = car.generalised_mass[0], corner.unsprung_mass_kg
    share = corner.body_load_n / GRAVITY_M_S2 / body
    yield _Quantity(
        body_name, body, "kg",
        f"loads wheel {wheel} with {{}} its own unsprung_mass_kg = {unsprung:g} kg", "times",
        lambda mass: mass * share / unsprung, (1.0, 1000.0), (3.0, 25.0),
    )  # fmt: skip
    yield _Quantity(
        body_name, body, "kg", f"puts {{}} on wheel {wheel}", "kg",
        lambda mass: mass * share, (0.0, np.inf), (100.0, 1500.0),
    )  # fmt: skip


def _suspension(car: Any, corner: Corner, index: str) -> Iterator[_Quantity]:
    radius_m, load_n = car.wheel_radius_m, corner.body_load_n
    yield _Quantity(
        f"tyre_n_m{index}", corner.tyre_n_m, "N/m", "lets the tyre sink by {}", "m",
        lambda stiffness: corner.static_tyre_n / stiffness,
        (0.005 * radius_m, radius_m), (0.02 * radius_m, 0.25 * radius_m),
    )  # fmt: skip
    yield _Quantity(
        f"spring_n_m{index}", corner.spring_n_m, "N/m", "lets the spring sink by {}", "m",
        lambda stiffness: load_n / stiffness,
        (SHORTEST_SPRING_M, MAX_SPRING_DEFLECTION_M), (0.02, 0.5),
    )  # fmt: skip
    critical = 2.0 * np.sqrt(corner.spring_n_m * load_n / GRAVITY_M_S2)
    yield _Quantity(
        f"damping_passive_ns_m{index}", corner.damping_passive_ns_m, "N·s/m", "is {} critical damping",
        "times", lambda damping: damping / critical, (0.0, np.inf), (0.05, 1.0),
    )  # fmt: skip


def _limit(name: str, effect: str, value: float, low: float, high: float, unit: str) -> None:
    if not low <= value <= high:
        raise InputError(f"{name} must {effect} {low:g} ... {high:g} {unit}, got {value:.4g} {unit}")


def _frequencies_hz(stiffness: Array, mass: Array) -> Array:
    """Undamped natural frequencies, ascending: those of the body first."""
    root = np.sqrt(mass)
    squares = np.linalg.eigvalsh(stiffness / np.outer(root, root))
    return np.sqrt(np.maximum(squares, 0.0)) / (2 * np.pi)


def _matrices(car: Any) -> tuple[Array, Array, Array]:
    """Stiffness and damping matrices at maximum damping, and the diagonal of the mass matrix."""
    bodies, corners = len(car.generalised_mass), car.corners
    mass = np.array([*car.generalised_mass, *(corner.unsprung_mass_kg for corner in corners)], float)
    stiffness, damping = np.zeros((len(mass), len(mass))), np.zeros((len(mass), len(mass)))
    struts = []
    for i, corner in enumerate(corners):
        strut = np.zeros(len(mass))
        strut[:bodies], strut[bodies + i] = corner.kinematic_row, -1.0
        stiffness += corner.spring_n_m * np.outer(strut, strut)
        damping += corner.damping_max_ns_m * np.outer(strut, strut)
        stiffness[bodies + i, bodies + i] += corner.tyre_n_m
        damping[bodies + i, bodies + i] += corner.tyre_damping_ns_m
        struts.append(strut)
    for axle, bar in enumerate(car.anti_roll_n_m):
        twist = struts[2 * axle] - struts[2 * axle + 1]
        stiffness += bar * np.outer(twist, twist)
    return stiffness, damping, mass
