"""Tests that every number in a file has a bounded range and a unit, which is enforced."""

import math
from collections.abc import Iterator
from dataclasses import MISSING, fields
from functools import cache
from pathlib import Path
from typing import Any, Literal, get_args, get_origin, get_type_hints

import pytest

from foreride.controller.settings import ControllerSettings
from foreride.files.errors import InputError
from foreride.files.plugins import Registry
from foreride.files.reading import strict
from foreride.files.reading.ranges import Checked, Number, number_of, numbers_in
from foreride.preview.prior_drives.memory_file import Memory
from foreride.scenarios.definition.loading import load, names
from foreride.scenarios.definition.schema import Scenario
from foreride.scenarios.definition.sets import load_all, set_names
from foreride.scenarios.reference_docs import blocks
from foreride.scenarios.studies.axis import Axis
from foreride.scenarios.studies.recipes import Recipe
from foreride.scenarios.studies.study import Study
from foreride.vehicle.load import Car, load_vehicle

ROOTS = (Scenario, ControllerSettings, Memory, Study, Axis, *get_args(Car), *get_args(Recipe))
FAR = (1e300, -1e300, math.nan, math.inf, -math.inf, 10**400)


def numeric(hint: Any) -> bool:
    """Whether an annotation admits numbers, with or without range."""
    if hint in (int, float) or number_of(hint) is not None:
        return True
    return any(numeric(inner) for inner in get_args(hint)) and get_origin(hint) is not None


@cache
def classes() -> dict[type, str]:
    return {cls: path for root in ROOTS for path, cls in blocks(root)}


def fields_with_numbers() -> Iterator[tuple[type, str, Any]]:
    for cls in classes():
        hints = get_type_hints(cls, include_extras=True)
        yield from ((cls, item.name, hints[item.name]) for item in fields(cls) if item.init)


NUMBERS = [field for field in fields_with_numbers() if numeric(field[2]) and field[1] != "values"]
"""Class, name and annotation; the values of a study's axis are judged by the field that they are for."""
IDS = [f"{cls.__name__}.{name}" for cls, name, _ in NUMBERS]


def bare(hint: Any) -> bool:
    """Whether an annotation admits a number without a range."""
    if number_of(hint) is not None:
        return False
    return hint in (int, float) or any(bare(inner) for inner in get_args(hint))


def with_first_number(hint: Any, value: Any) -> Any:
    """Value of the annotation whose first number is `value`."""
    if number_of(hint) is not None:
        return value
    inner = get_args(hint)
    if get_origin(hint) is dict:
        return {"a": value}
    if get_origin(hint) is tuple:
        rest = [] if inner[-1] is Ellipsis else [with_first_number(other, low(other)) for other in inner[1:]]
        return [with_first_number(inner[0], value), *rest]
    return with_first_number(next(member for member in inner if numeric(member)), value)


def low(hint: Any) -> float:
    return next(numbers_in(hint)).bounds()[0]


def test_there_are_numbers() -> None:
    assert len(NUMBERS) > 200


@pytest.mark.parametrize(("cls", "name", "hint"), NUMBERS, ids=IDS)
def test_each_number_has_a_bounded_range_and_a_unit(cls: type, name: str, hint: Any) -> None:
    assert not bare(hint)
    assert issubclass(cls, Checked)
    for number in numbers_in(hint):
        bounds = number.bounds()
        assert all(math.isfinite(bound) for bound in bounds)
        assert bounds[0] < bounds[1]
        assert number.unit


@pytest.mark.parametrize(("cls", "name", "hint"), NUMBERS, ids=IDS)
def test_absurd_numbers_are_refused_by_name(cls: type, name: str, hint: Any) -> None:
    number, given = next(numbers_in(hint)), required(cls)
    billion = 10**9 if number.is_integer else 1e9
    # A seed may be that large, and a study's axis has the unit of the field that it varies.
    large = () if number.bounds()[1] > billion else (billion,)
    for value in (*FAR, *large, *tiny(number)):
        with pytest.raises(InputError) as caught:
            strict.structure(cls, given | {name: with_first_number(hint, value)}, "s.yaml")
        message = str(caught.value)
        assert message.startswith(f"s.yaml: {name}")
        assert "\n" not in message
        assert len(message) < 300
        assert number.text() in message or "finite number" in message or "whole number" in message


def tiny(number: Number) -> tuple[float, ...]:
    """Denormal numbers where the range is not signed."""
    return () if number.is_integer or number.bounds()[0] < 0 else (1e-300, 5e-324)


def required(cls: Any) -> dict[str, Any]:
    """Mapping of the fields without default."""
    hints = get_type_hints(cls, include_extras=True)
    without = [f for f in fields(cls) if f.default is MISSING and f.default_factory is MISSING]
    return {item.name: least(hints[item.name]) for item in without}


def least(hint: Any) -> Any:
    """Plain value that such a field accepts."""
    if hint == Car:
        return strict.to_mapping(load_vehicle("quarter"))
    if (number := number_of(hint)) is not None:
        return number.bounds()[1 if number.in_range(number.bounds()[1]) else 0]
    members = get_args(hint)
    if registry := next((member for member in members if isinstance(member, Registry)), None):
        return {"kind": (name := next(iter(registry.own)))} | required(registry.own[name])
    if get_origin(hint) is Literal:
        return members[0]
    if get_origin(hint) is tuple:
        return [least(inner) for inner in members if inner is not Ellipsis]
    if members:
        return None if type(None) in members else {"kind": members[0].kind} | required(members[0])
    return "x" if hint is str else required(hint)


def test_the_shipped_library_and_vehicles_load() -> None:
    assert [load(name).name for name in names()] == names()
    assert load_all(set_names())
    for path in (Path(__file__).parents[2] / "vehicle" / "parameters").glob("*.yaml"):
        assert load_vehicle(path).wheels in (1, 2, 4)
