"""Strict JSON (RFC 8259): no NaN, no duplicate keys, bounded size, depth and digits, one-line errors."""

import json
from pathlib import Path
from typing import Any

from foreride.files.errors import InputError, shown
from foreride.files.reading.regular_file import read_text, reading

JSON_LIMIT = 64 << 20
"""Maximum size of a JSON file of results: 64 MiB, read in seconds."""
DEPTH = 64
"""Maximum nesting depth of lists and objects."""
_DIGITS = 300
"""Maximum number of digits of an integer, so that it can be converted to a float."""


def read_json(path: Path | str, limit: int = JSON_LIMIT) -> Any:
    """Parse a JSON file of at most `limit` bytes; InputError names the file and the fault."""
    return parse_json(read_text(path, limit), str(path))


def read_json_lines(path: Path | str, limit: int = JSON_LIMIT) -> list[Any]:
    """Parse a file of one JSON value per line; InputError names the file and the line."""
    lines = read_text(path, limit).split("\n")
    return [parse_json(line, f"{path}:{number}") for number, line in enumerate(lines, 1) if line.strip()]


def parse_json(text: str, source: str) -> Any:
    """Parse JSON text; InputError names `source` and the fault."""
    with reading(source):
        try:
            value = json.loads(
                text,
                object_pairs_hook=_object,
                parse_constant=_constant,
                parse_int=_integer,
                parse_float=_number,
            )
            _check(value, DEPTH)
        except InputError as error:
            raise InputError(f"{source}: {error}") from None
        except json.JSONDecodeError as error:
            location = f"line {error.lineno}, column {error.colno}"
            raise InputError(f"{source}: is not valid JSON ({error.msg}, {location})") from None
        except UnicodeEncodeError:
            raise InputError(f"{source}: holds a lone surrogate, which is not text") from None
    return value


def _object(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    mapping = dict(pairs)
    if len(mapping) < len(pairs):
        names = [name for name, _ in pairs]
        duplicate = next(name for name in mapping if names.count(name) > 1)
        raise InputError(f"the key {shown(duplicate)} appears twice")
    return mapping


def _constant(name: str) -> Any:
    raise InputError(f"numbers must be finite, got {name}")


def _integer(text: str) -> int:
    if len(text) > _DIGITS:
        raise InputError(f"whole numbers must have at most {_DIGITS} digits, got {len(text)}")
    return int(text)


def _number(text: str) -> float:
    value = float(text)
    if abs(value) == float("inf"):
        raise InputError(f"numbers must be finite, got {shown(text)}")
    return value


def _check(value: Any, levels_left: int) -> None:
    """Check depth and texts of a value; raise UnicodeEncodeError for a text that has no UTF-8 encoding."""
    if isinstance(value, str):
        value.encode()
        if "\0" in value:
            raise InputError(f"texts must not hold NUL characters, got {shown(value)}")
    elif isinstance(value, dict | list):
        if not levels_left:
            raise InputError(f"is nested more than {DEPTH} deep")
        if isinstance(value, dict):
            for name in value:
                _check(name, levels_left)
        for child in value.values() if isinstance(value, dict) else value:
            _check(child, levels_left - 1)
