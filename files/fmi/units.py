"""Units of FMI variables: exponents of the SI base units, and conversion between a declared and our unit."""

from typing import Any, NamedTuple

from foreride.files.errors import InputError, printable

BASE_UNITS: dict[str, dict[str, int]] = {
    "1": {},
    "s": {"s": 1},
    "m": {"m": 1},
    "m/s": {"m": 1, "s": -1},
    "m/s²": {"m": 1, "s": -2},
    "rad": {"rad": 1},
    "rad/s": {"rad": 1, "s": -1},
    "rad/s²": {"rad": 1, "s": -2},
    "N": {"kg": 1, "m": 1, "s": -2},
    "N·s/m": {"kg": 1, "s": -1},
    "m²/s⁴": {"m": 2, "s": -4},
}
"""Exponents of the SI base units (and of rad) of each unit that a quantity of ours may have."""
_SPELLINGS = str.maketrans({"²": "2", "⁴": "4", "·": ".", "*": ".", "^": None, " ": None})


class Declared(NamedTuple):
    """Unit as a model description declares it: its name and, if defined, exponents, factor and offset.

    A value in the SI base units is factor · value + offset.
    """

    name: str
    exponents: dict[str, int] | None = None
    factor: float = 1.0
    offset: float = 0.0


def conversion(declared: Declared | None, unit: str) -> tuple[float, float]:
    """Factor and offset from a declared unit to `unit`, one of `BASE_UNITS`; one without a unit is in ours.

    Raises InputError if the declared one measures something else or is not defined. A radian counts as 1.
    """
    if declared is None or (declared.exponents is None and _spelt(declared.name) == _spelt(unit)):
        return 1.0, 0.0
    if declared.exponents is None:
        raise InputError(f"has the undefined unit {printable(declared.name)}, not {unit}")
    if _dimension(declared.exponents) != _dimension(BASE_UNITS[unit]) or not declared.factor:
        raise InputError(f"has the unit {printable(declared.name)}, which cannot be converted to {unit}")
    return declared.factor, declared.offset


def _dimension(exponents: dict[str, Any]) -> dict[str, int]:
    return {base: int(power) for base, power in exponents.items() if power and base != "rad"}


def _spelt(unit: str) -> str:
    return unit.translate(_SPELLINGS)
