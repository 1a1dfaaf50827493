"""Range and unit of numbers in their annotations, and the single check of them.

A field is annotated as `Annotated[float, Interval(ge=1.0, le=200.0), "Hz"]`; the unit of a plain ratio is
"1". A dataclass that derives from `Checked`, or calls `check` in its `__post_init__`, holds no number outside
its range, whether it was read from a file or built in code. If a range begins at 0, a number above it is at
least `MIN_POSITIVE`, so that division by it is safe.
"""

import math
import types
from collections.abc import Iterator, Sequence
from dataclasses import fields, is_dataclass
from functools import cache
from numbers import Integral, Real
from typing import Annotated, Any, NamedTuple, Union, get_args, get_origin, get_type_hints

from annotated_types import Interval

from foreride.files.errors import InputError, shown
from foreride.files.reading.units import unit_hint

MIN_POSITIVE = 1e-15

Share = Annotated[float, Interval(ge=0.0, le=1.0), "1"]
MAX_SEED = 2**32 - 1
Seed = Annotated[int, Interval(ge=0, le=MAX_SEED), "1"]


class Number(NamedTuple):
    """Range and unit of a number, read from its annotation."""

    is_integer: bool
    interval: Interval
    unit: str

    def text(self) -> str:
        """Text of the range with its unit, for messages and reference pages."""
        low, high = (f"{bound:.10g}" for bound in self.bounds())
        unit = "" if self.unit == "1" else f" {self.unit}"
        if self.interval.gt is None and self.interval.lt is None:
            return f"{low} ... {high}{unit}"
        signs = ">=" if self.interval.gt is None else ">", "<=" if self.interval.lt is None else "<"
        return f"{signs[0]} {low} and {signs[1]} {high}{unit}"

    def bounds(self) -> tuple[float, float]:
        """Lowest and highest value, or the limits they must stay within."""
        i: Any = self.interval
        low, high = (i.ge if i.gt is None else i.gt), (i.le if i.lt is None else i.lt)
        return -math.inf if low is None else low, math.inf if high is None else high

    def has_type(self, value: Any) -> bool:
        """Whether the value has this number's type, in range or not."""
        return isinstance(value, Integral if self.is_integer else Real) and not isinstance(value, bool)

    def in_range(self, value: Any) -> bool:
        """Whether the value is in range; the comparisons also hold for integers of any size."""
        if not self.has_type(value):
            return False
        (low, high), i = self.bounds(), self.interval
        if not low <= value <= high or value in (i.gt, i.lt):
            return False
        return not (low == 0.0 < value < MIN_POSITIVE)


class Checked:
    """Base of dataclasses whose numbers are checked against their annotations on construction."""

    def __post_init__(self) -> None:
        check(self)


def check(values: Any) -> None:
    """Raise InputError, naming the field, unless all numbers of a dataclass lie in their ranges."""
    cls: Any = type(values)
    for name, hint, number in _ranged(cls):
        value = getattr(values, name)
        if number is None or not number.in_range(value):
            _check(name, value, hint)


def number_of(hint: Any) -> Number | None:
    """Range and unit of an annotation; None if it stands for no number."""
    if get_origin(hint) is not Annotated:
        return None
    kind, *metadata = get_args(hint)
    interval = next((item for item in metadata if isinstance(item, Interval)), None)
    unit = next((item for item in metadata if isinstance(item, str)), "1")
    return Number(kind is int, interval, unit) if interval else None


def check_field(root: Any, path: Sequence[str], label: str, value: Any) -> None:
    """Raise InputError, by `label`, unless the field at `path` under `root` may hold the value.

    A path that leads nowhere, and a field that holds no number, are not judged.
    """
    place, hint = root, None
    for key in path:
        if isinstance(place, tuple) and key.isdecimal() and int(key) < len(place):
            place = place[int(key)]
        elif isinstance(place, dict) and key in place:
            place = place[key]
        elif is_dataclass(place) and hasattr(place, key):
            hint, place = get_type_hints(type(place), include_extras=True).get(key), getattr(place, key)
        else:
            return
    numbers = list(numbers_in(hint))
    if numbers and not any(number.in_range(value) for number in numbers):
        _check_number(label, value, numbers[0])


def numbers_in(hint: Any) -> Iterator[Number]:
    """Numbers that a field with this annotation may hold, except those of inner dataclasses."""
    number = number_of(hint)
    if number is not None:
        yield number
        return
    for argument in get_args(hint):
        yield from numbers_in(argument)


@cache
def _ranged(cls: Any) -> tuple[tuple[str, Any, Number | None], ...]:
    """Names and annotations of the fields that hold numbers, with the range of a single one."""
    hints = get_type_hints(cls, include_extras=True)
    named = [(f.name, hints[f.name]) for f in fields(cls)]
    return tuple((name, hint, number_of(hint)) for name, hint in named if any(True for _ in numbers_in(hint)))


def _check(name: str, value: Any, hint: Any) -> None:
    origin, arguments = get_origin(hint), get_args(hint)
    if (number := number_of(hint)) is not None:
        _check_number(name, value, number)
    elif origin is tuple:
        _check_tuple(name, value, arguments)
    elif origin is dict:
        for key, item in value.items():
            _check(f"{name}.{key}", item, arguments[1])
    elif origin in (Union, types.UnionType) and value is not None:
        for member in arguments:
            _check(name, value, member)


def _check_tuple(name: str, values: Any, hints: tuple[Any, ...]) -> None:
    if hints[-1] is Ellipsis:
        hints = hints[:1] * len(values)
    if len(values) != len(hints):
        raise InputError(f"{name} must hold {len(hints)} values, got {len(values)}")
    for i, (value, hint) in enumerate(zip(values, hints, strict=True)):
        _check(f"{name}[{i}]", value, hint)


def _check_number(name: str, value: Any, number: Number) -> None:
    if number.in_range(value):
        return
    allowed = f"lie in {number.text()}" if "..." in number.text() else f"be {number.text()}"
    if not number.has_type(value):
        allowed = f"be {'a whole number' if number.is_integer else 'a number'}, and {allowed}"
    elif 0 < value < MIN_POSITIVE:
        allowed += f", and be 0 or at least {MIN_POSITIVE:g}"
    raise InputError(f"{name} must {allowed}, got {shown(value)}{_unit_hint(value, number)}")


def _unit_hint(value: Any, number: Number) -> str:
    high = number.bounds()[1]
    if number.is_integer or not number.has_type(value) or not high < value < 1e15:
        return ""
    return unit_hint(float(value), number.unit, number.in_range)
