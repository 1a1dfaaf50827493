"""Mutation of YAML and JSON by their structure: values replaced, keys dropped, doubled and renamed."""

import json
from collections.abc import Iterator
from functools import lru_cache
from random import Random
from typing import Any

import yaml

from tests.fuzz.extremes import NUMBERS, OTHERS, TEXTS

Slot = tuple[list, int]
"""A list and the index in it at which a value stands."""


class Spelt(str):
    """A value that is written as it stands here."""


class Pairs(list):
    """A mapping as a list of [key, value], so that keys can stand twice."""


def mutated(rng: Random, data: bytes) -> bytes | None:
    """The document, or one line of it, with one to three changes; None where it is neither YAML nor JSON."""
    text = data.decode("utf-8", "replace")
    lines = text.splitlines()
    if len(lines) > 1 and lines[0][:1] in "{[":  # one document a line
        place = rng.randrange(len(lines))
        return "\n".join([*lines[:place], _document(rng, lines[place]) or "", *lines[place + 1 :]]).encode()
    changed = _document(rng, text)
    return None if changed is None else changed.encode("utf-8", "surrogatepass")


def _document(rng: Random, text: str) -> str | None:
    tree = _parsed(text)
    if not isinstance(tree, dict | list):
        return None
    root = [_opened(tree)]
    for _ in range(rng.choice((1, 1, 1, 2, 3))):
        _change(rng, list(_slots(root)))
    return _spelt(root[0]) if root else ""


@lru_cache(maxsize=256)
def _parsed(text: str) -> Any:
    try:
        return json.loads(text)
    except ValueError:
        try:
            return yaml.safe_load(text)
        except (yaml.YAMLError, ValueError):
            return None


def _change(rng: Random, slots: list[Slot]) -> None:
    if not slots:
        return
    holder, index = rng.choice(slots)
    kind = rng.random()
    if kind < 0.5:
        holder[index] = _extreme(rng)
    elif kind < 0.6:
        there, place = rng.choice(slots)
        holder[index] = _closed(there[place])
    elif kind < 0.7:
        holder[index] = _scaled(rng, holder[index])
    else:
        _reshape(rng, holder, index)


def _reshape(rng: Random, holder: list, index: int) -> None:
    """Drop, double, rename or wrap what stands in the list or mapping at that place."""
    inner = holder[index]
    if not isinstance(inner, list) or not inner:
        holder[index] = rng.choice(([inner], Pairs([["kind", inner]]), _extreme(rng)))
        return
    place = rng.randrange(len(inner))
    if rng.random() < 0.4:
        del inner[place]
    elif rng.random() < 0.5:
        inner.insert(rng.randrange(len(inner) + 1), inner[place])
    elif isinstance(inner, Pairs):
        inner[place] = [rng.choice((*(pair[0] for pair in inner), _extreme(rng))), inner[place][1]]


def _extreme(rng: Random) -> Spelt:
    return Spelt(rng.choice(rng.choice((NUMBERS, NUMBERS, TEXTS, OTHERS))))


def _scaled(rng: Random, value: Any) -> Any:
    if isinstance(value, bool) or not isinstance(value, int | float):
        return _extreme(rng)
    return Spelt(repr(value * rng.choice((-1, 0.5, 2, 10, 0.1, 1e3, 1e-3, 1e6, 1e-6, 1e12))))


def _slots(holder: list) -> Iterator[Slot]:
    """Every place of a value at and below those of the list."""
    for index, value in enumerate(holder):
        if isinstance(holder, Pairs):
            yield value, 1
            inner = value[1]
        else:
            yield holder, index
            inner = value
        if isinstance(inner, list):
            yield from _slots(inner)


def _opened(value: Any) -> Any:
    if isinstance(value, dict):
        return Pairs([key, _opened(inner)] for key, inner in value.items())
    return [_opened(inner) for inner in value] if isinstance(value, list) else value


def _closed(value: Any) -> Any:
    """A copy that shares nothing with the value."""
    if isinstance(value, list):
        return type(value)(_closed(inner) for inner in value)
    return value


def _spelt(value: Any) -> str:
    if isinstance(value, Spelt):
        return str(value)
    if isinstance(value, Pairs):
        return "{" + ", ".join(f"{_spelt(key)}: {_spelt(inner)}" for key, inner in value) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(_spelt, value)) + "]"
    return json.dumps(value, default=str)
