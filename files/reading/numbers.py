"""Parsing of integers from text, as given on command lines and in metadata, and range checks."""

import math
import re

from foreride.files.errors import InputError, shown

_INTEGER = re.compile(r"[0-9]{1,10}")


def is_integer(text: str) -> bool:
    """Whether the text is one to ten ASCII digits; `str.isdigit` would also accept superscripts."""
    return _INTEGER.fullmatch(text) is not None


def parse_integer(text: str, name: str, low: int, high: int) -> int:
    """Parse an integer; raise InputError, by `name`, unless it lies in low ... high."""
    if not (is_integer(text) and low <= int(text) <= high):
        raise InputError(f"{name} must be a whole number in {low} ... {high}, got {shown(text)}")
    return int(text)


def within(name: str, value: float, low: float, high: float, unit: str = "") -> None:
    """Raise InputError, by `name`, unless the number lies in low ... high."""
    if not (-math.inf < value < math.inf and low <= value <= high):  # holds for integers of any size
        allowed = f"{low:.10g} ... {high:.10g} {unit}".rstrip()
        raise InputError(f"{name} must lie in {allowed}, got {shown(value)}")
