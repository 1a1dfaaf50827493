"""Whole numbers and decimals spelled in text, as command lines and metadata give them."""

import math
import re

from files.errors import InputError, shown

_WHOLE = re.compile(r"[0-9]{1,9}")


def is_whole(text: str) -> bool:
    """Whether the text is one to nine plain digits; `str.isdigit` takes superscripts for such, too."""
    return _WHOLE.fullmatch(text) is not None


def whole(text: str, name: str, low: int, high: int) -> int:
    """The whole number that the text spells; InputError, by `name`, unless it lies in low ... high."""
    if not (is_whole(text) and low <= int(text) <= high):
        raise InputError(f"{name} must be a whole number in {low} ... {high}, got {shown(text)}")
    return int(text)


def within(name: str, value: float, low: float, high: float, unit: str = "") -> None:
    """Raise InputError, by `name`, unless the number lies in low ... high."""
    if not (math.isfinite(value) and low <= value <= high):
        allowed = f"{low:g} ... {high:g} {unit}".rstrip()
        raise InputError(f"{name} must lie in {allowed}, got {shown(value)}")
