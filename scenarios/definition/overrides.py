"""Overrides: single fields of a scenario's document replaced before it is validated.

In Python they are a mapping, nested (`{"camera": {"latency_s": 0.1}}`) or with dotted keys
(`{"camera.latency_s": 0.1}`); on the command line a text (`camera.latency_s=0.1`). An entry of a list
is named by its index, `features.0.height_m` or `features[0].height_m`.
"""

import json
import os
import re
from collections.abc import Iterator, Mapping, Sequence
from copy import deepcopy
from dataclasses import dataclass
from typing import Any

from foreride.files.errors import InputError, shortened, shown
from foreride.files.reading.numbers import is_integer
from foreride.files.reading.yaml12 import parse

_INDEX = re.compile(r"\[(\d+)\]")


@dataclass(frozen=True)
class Override:
    """One field to replace.

    path: keys and list indices, outermost first. value: the new value, plain as in a YAML file. shown: the
    override as its user wrote it, for messages.
    """

    path: tuple[str, ...]
    value: Any
    shown: str

    @property
    def text(self) -> str:
        """The override as for `--set`, the same for the same path and value."""
        return f"{'.'.join(self.path)}={_value_text(self.value)}"

    def apply(self, document: dict[str, Any]) -> None:
        """Replace the field in a document. Raises InputError for a path that the document cannot have."""
        place: Any = document
        for key in self.path[:-1]:
            place = self._inner(place, key)
        place[self._key(place, self.path[-1])] = deepcopy(self.value)

    def _inner(self, place: Any, key: str) -> Any:
        if isinstance(place, dict) and place.get(key) is None:
            place[key] = {}
        inner = place[self._key(place, key)]
        if not isinstance(inner, dict | list):
            raise InputError(f"{self.shown}: {shortened(key)} is a single value, it has no fields")
        return inner

    def _key(self, place: dict[str, Any] | list[Any], key: str) -> Any:
        if isinstance(place, dict):
            return key
        if not is_integer(key) or not 0 <= int(key) < len(place):
            raise InputError(f"{self.shown}: {shortened(key)} must be an index 0 ... {len(place) - 1}")
        return int(key)


Overrides = Mapping[str, Any] | Sequence[Override | str]
"""A mapping, or overrides and texts as for `--set`; a later one replaces an earlier one of the same field."""


def parse_override(text: str) -> Override:
    """Parse `path.to.field=value`, where the value is YAML."""
    label = f"--set {shown(text)}"
    dotted, separator, value = text.partition("=")
    path = split_path(dotted.strip())
    if not separator or not all(path):
        raise InputError(f"{label}: must read path.to.field=value")
    return Override(path, parse(value, label), label)


def collect_overrides(given: Overrides) -> tuple[Override, ...]:
    """Convert what a user gives to overrides. Raises InputError for malformed ones."""
    if isinstance(given, Mapping):
        return tuple(_flattened(given, ()))
    if isinstance(given, str):
        raise InputError(f"overrides must be a mapping of fields to values, got {shown(given)}")
    return tuple(one if isinstance(one, Override) else parse_override(one) for one in given)


def split_path(dotted: str) -> tuple[str, ...]:
    """Keys and indices of a path in dotted or bracket notation."""
    return tuple(_INDEX.sub(r".\1", dotted).split("."))


def _flattened(mapping: Mapping[str, Any], outer: tuple[str, ...]) -> Iterator[Override]:
    """Overrides of a nested mapping; a block with `kind` is one of several types and replaced as a whole."""
    for key, value in mapping.items():
        label = f"override {shown('.'.join([*outer, str(key)]))}"
        path = (*outer, *split_path(str(key)))
        if not isinstance(key, str | int) or not all(path):
            raise InputError(f"{label}: must name fields as path.to.field")
        if isinstance(value, Mapping) and "kind" not in value:
            yield from _flattened(value, path)
        else:
            yield Override(path, _plain(value), label)


def _plain(value: Any) -> Any:
    """The value as YAML holds it, without types of NumPy, tuples and paths."""
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, Mapping):
        return {key: _plain(inner) for key, inner in value.items()}
    return [_plain(inner) for inner in value] if isinstance(value, list | tuple) else value


def _value_text(value: Any) -> str:
    """Text that YAML parses back to the value: bare where a word stands for itself, else JSON."""
    if isinstance(value, str):
        try:
            bare = parse(value, "") == value
        except InputError:
            bare = False
        return value if bare else json.dumps(value)
    return json.dumps(value, default=str)
