"""Input errors: the exception for invalid input, and the bounded texts of its messages."""

import difflib
import reprlib
from collections.abc import Iterable
from typing import Any

MESSAGE_LENGTH = 500
"""Length that no message reaches."""
SHOWN_LENGTH = 60
"""Maximum length of a message part that repeats a value from the input."""
_MAX_NAME_LENGTH = 100
"""Length above which no similar name is searched, as that takes long."""


class InputError(ValueError):
    """Invalid input, reported in one line that names file, field, value and what is allowed.

    The message is one printable line of less than 500 characters, whatever it is made from.
    """

    def __init__(self, message: object = "") -> None:
        super().__init__(abridged(printable(message)))


class _BoundedRepr(reprlib.Repr):
    """`repr` in bounded time and length, however large or deeply nested the value is."""

    def __init__(self) -> None:
        super().__init__()
        self.maxlevel = 3
        self.maxstring = self.maxother = SHOWN_LENGTH

    def repr_int(self, x: int, level: int) -> str:
        # Python refuses to format integers of more than 4300 digits, and is slow for long ones.
        return (
            repr(x)
            if x.bit_length() <= 128
            else f"a whole number of about {x.bit_length() * 0.30103:.0f} digits"
        )


_BOUNDED = _BoundedRepr()


def shown(value: Any) -> str:
    """Format a value for a message: one printable line of at most `SHOWN_LENGTH` characters."""
    text = "nothing" if value is None else _BOUNDED.repr(value)
    return shortened(printable(text))


def nearest(name: Any, allowed: Iterable[Any]) -> str:
    """Hint at the most similar of the allowed names, to append to a message; "" if none is similar."""
    if not isinstance(name, str) or len(name) > _MAX_NAME_LENGTH:
        return ""
    close = difflib.get_close_matches(name, [str(item) for item in allowed], n=1)
    return f"; did you mean {close[0]}?" if close else ""


def shortened(text: str, length: int = SHOWN_LENGTH) -> str:
    """Truncate the text to `length` characters."""
    return text if len(text) <= length else f"{text[: length - 3]}..."


def abridged(text: str, length: int = MESSAGE_LENGTH - 1) -> str:
    """Truncate a text longer than `length` in the middle, as the cause stands at a message's end."""
    if len(text) <= length:
        return text
    head = (length - 5) // 2
    return f"{text[:head]} ... {text[len(text) - (length - 5 - head) :]}"


def printable(text: object) -> str:
    """The text in one line without control characters and lone surrogates, which terminals cannot display."""
    line = " ".join(str(text).split())
    if line.isprintable():
        return line
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode("ascii") for c in line)
