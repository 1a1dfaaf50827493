"""Seeded mutations of valid files: bytes, lines, numbers, structure, and splices of two files."""

import re
from collections.abc import Callable, Sequence
from random import Random

from tests.fuzz import trees
from tests.fuzz.extremes import BYTES, NUMBERS, bomb

_NUMBER = re.compile(rb"[-+]?\d+(?:\.\d*)?(?:[eE][-+]?\d+)?")


def mutation(seed: int, name: str, index: int, valid: bytes, others: Sequence[bytes]) -> bytes:
    """The input of that number for the reader called `name`: the same bytes in every process."""
    rng = Random(f"{seed} {name} {index}")
    if index % 2 and (changed := trees.mutated(rng, valid)) is not None:
        return changed
    if rng.random() < 0.02:
        return rng.choice((b"", bomb(), valid + valid, rng.randbytes(rng.randrange(400))))
    data = _spliced(rng, valid, rng.choice(others)) if others and rng.random() < 0.1 else valid
    for _ in range(rng.choice((1, 1, 2, 4))):
        data = rng.choice(_KINDS)(rng, data)
    return data


def _flip(rng: Random, data: bytes) -> bytes:
    changed = bytearray(data)
    for _ in range(rng.choice((1, 1, 2, 8))):
        if changed:
            changed[rng.randrange(len(changed))] ^= 1 << rng.randrange(8)
    return bytes(changed)


def _head(rng: Random, data: bytes) -> bytes:
    """Headers are where files say how large they are."""
    place = rng.randrange(min(len(data), 64) or 1)
    return data[:place] + rng.randbytes(1) + data[place + 1 :]


def _truncate(rng: Random, data: bytes) -> bytes:
    return data[: rng.randrange(len(data) + 1)]


def _span(rng: Random, data: bytes) -> tuple[int, int]:
    start = rng.randrange(len(data) + 1)
    return start, min(len(data), start + rng.choice((1, 2, 4, 16, 256)))


def _delete(rng: Random, data: bytes) -> bytes:
    start, stop = _span(rng, data)
    return data[:start] + data[stop:]


def _double(rng: Random, data: bytes) -> bytes:
    start, stop = _span(rng, data)
    return data[:stop] + data[start:stop] * rng.choice((1, 2, 20)) + data[stop:]


def _insert(rng: Random, data: bytes) -> bytes:
    start, stop = _span(rng, data)
    return data[:start] + rng.choice(BYTES) + data[stop if rng.random() < 0.5 else start :]


def _number(rng: Random, data: bytes) -> bytes:
    found = list(_NUMBER.finditer(data[:20_000]))
    if not found:
        return _flip(rng, data)
    one = rng.choice(found)
    return data[: one.start()] + rng.choice(NUMBERS).encode() + data[one.end() :]


def _line(rng: Random, data: bytes) -> bytes:
    lines = data.split(b"\n")
    place = rng.randrange(len(lines))
    kind = rng.randrange(3)
    if kind == 0:
        del lines[place]
    elif kind == 1:
        lines.insert(rng.randrange(len(lines)), lines[place])
    else:
        lines[place] = rng.choice(BYTES)
    return b"\n".join(lines)


def _spliced(rng: Random, one: bytes, other: bytes) -> bytes:
    return one[: rng.randrange(len(one) + 1)] + other[rng.randrange(len(other) + 1) :]


_KINDS: tuple[Callable[[Random, bytes], bytes], ...] = (
    _flip, _flip, _head, _truncate, _delete, _double, _insert, _number, _line,
)  # fmt: skip
