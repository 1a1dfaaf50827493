"""Parsing of integers from text, as given on command lines and in metadata, and range checks."""

import math
import re
from collections.abc import Iterable

from foreride.files.errors import InputError, shown

MAX_RANGE = 100_000
"""Maximum number of integers that one option may list."""
_INTEGER = re.compile(r"[0-9]{1,10}")


def is_integer(text: str) -> bool:
    """Whether the text is one to ten ASCII digits; `str.isdigit` would also accept superscripts."""
    return _INTEGER.fullmatch(text) is not None


def parse_integer(text: str, name: str, low: int, high: int) -> int:
    """Parse an integer; raise InputError, by `name`, unless it lies in low ... high."""
    if not (is_integer(text) and low <= int(text) <= high):
        raise InputError(f"{name} must be a whole number in {low} ... {high}, got {shown(text)}")
    return int(text)


def parse_whole_numbers(name: str, words: Iterable[str], high: int) -> list[int]:
    """Parse integers 0 ... high and ranges of them such as `0-4`; each counts once, in the order given.

    Raises InputError, by `name`, for anything else and for more than `MAX_RANGE` numbers.
    """
    numbers: dict[int, None] = {}
    for word in words:
        first, dash, last = word.partition("-")
        ends = [int(text) for text in ((first, last) if dash else (first,)) if is_integer(text)]
        if len(ends) != 1 + len(dash) or max(ends) > high or ends[0] > ends[-1]:
            allowed = f"whole numbers in 0 ... {high}, or ranges such as 0-4"
            raise InputError(f"{name} must be {allowed}, separated by commas, got {shown(word)}")
        if len(numbers) + ends[-1] - ends[0] >= MAX_RANGE:
            raise InputError(f"{name} must be at most {MAX_RANGE} numbers, got {shown(word)}")
        numbers |= dict.fromkeys(range(ends[0], ends[-1] + 1))
    return list(numbers)


def within(name: str, value: float, low: float, high: float, unit: str = "") -> None:
    """Raise InputError, by `name`, unless the number lies in low ... high."""
    if not (-math.inf < value < math.inf and low <= value <= high):  # holds for integers of any size
        allowed = f"{low:.10g} ... {high:.10g} {unit}".rstrip()
        raise InputError(f"{name} must lie in {allowed}, got {shown(value)}")
