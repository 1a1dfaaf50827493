"""Common parts of the table commands: exit codes and parsing of list options."""

import sys
from collections.abc import Callable, Sequence
from functools import wraps

from foreride.files.errors import InputError
from foreride.files.reading.numbers import is_integer


def command(run: Callable[[Sequence[str] | None], object]) -> Callable[..., int]:
    """Wrap a `main` to return 0, or 2 after invalid input, which is reported in one line."""

    @wraps(run)
    def main(arguments: Sequence[str] | None = None) -> int:
        try:
            run(arguments)
        except InputError as error:
            print(f"error: {error}", file=sys.stderr)
            return 2
        return 0

    return main


def parse_words(option: str, text: str, allowed: Sequence[str]) -> list[str]:
    """Split a comma-separated option. Raises InputError for an entry that is not allowed."""
    asked = text.split(",")
    for word in asked:
        if word not in allowed:
            raise InputError(f"{option}: must be of {', '.join(allowed)}, got {word!r}")
    return asked


def whole_numbers(option: str, text: str) -> list[int]:
    """Split a comma-separated option into integers >= 0. Raises InputError."""
    asked = text.split(",")
    for word in asked:
        if not is_integer(word):
            raise InputError(f"{option}: must be whole numbers >= 0, separated by commas, got {word!r}")
    return [int(word) for word in asked]
