"""Units of foreign variables: converted where their definitions permit, refused otherwise."""

import pytest

from foreride.files.errors import InputError
from foreride.files.fmi.units import BASE_UNITS, Declared, conversion


def test_variable_without_a_unit_is_in_ours() -> None:
    assert conversion(None, "m") == (1.0, 0.0)


@pytest.mark.parametrize("unit", BASE_UNITS)
def test_own_units_need_no_conversion(unit: str) -> None:
    assert conversion(Declared(unit), unit) == (1.0, 0.0)
    assert conversion(Declared("x", dict(BASE_UNITS[unit])), unit) == (1.0, 0.0)


def test_defined_units_are_converted() -> None:
    assert conversion(Declared("mm", {"m": 1, "s": 0}, 1e-3), "m") == (1e-3, 0.0)
    assert conversion(Declared("deg", {"rad": 1}, 0.0174), "rad") == (0.0174, 0.0)
    assert conversion(Declared("1/s", {"s": -1}), "rad/s") == (1.0, 0.0)
    assert conversion(Declared("offset", {"m": 1}, 2.0, 0.5), "m") == (2.0, 0.5)


@pytest.mark.parametrize("name", ["N.s/m", "N*s/m", "N·s/m"])
def test_undefined_unit_of_the_same_name_is_ours(name: str) -> None:
    assert conversion(Declared(name), "N·s/m") == (1.0, 0.0)


@pytest.mark.parametrize(
    "declared",
    [Declared("mm"), Declared("kg", {"kg": 1}), Declared("s", {"s": 1}), Declared("m", {"m": 1}, 0.0)],
)
def test_other_units_are_refused_by_name(declared: Declared) -> None:
    with pytest.raises(InputError, match=f"unit {declared.name}"):
        conversion(declared, "m")
