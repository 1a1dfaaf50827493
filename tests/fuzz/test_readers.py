"""Whatever stands in place of a data file, its reader answers: a value, or one line that names the file."""

import os
from collections.abc import Callable
from pathlib import Path
from random import Random

import pytest

from foreride.files.errors import InputError
from tests.fuzz.readers import READERS


def answers(read: Callable[[Path], object], path: Path) -> str:
    """The one line in which the file is refused; empty where it is taken."""
    told = ""
    try:
        read(path)
    except InputError as error:
        told = str(error)
    assert told.isprintable()
    assert len(told) < 1000
    return told


@pytest.mark.parametrize("name", READERS)
def test_the_valid_file_of_each_reader_is_read(name: str, tmp_path: Path) -> None:
    path = READERS[name].place(tmp_path)
    assert path.stat().st_size > 0
    READERS[name].read(path)


@pytest.mark.parametrize("kind", ["pipe", "folder", "device", "loop"])
@pytest.mark.parametrize("name", READERS)
def test_only_a_regular_file_is_read(name: str, kind: str, tmp_path: Path) -> None:
    path = READERS[name].place(tmp_path)
    path.unlink()
    if kind == "pipe":
        os.mkfifo(path)
    elif kind == "folder":
        path.mkdir()
    else:
        path.symlink_to("/dev/zero" if kind == "device" else path.name)
    answers(READERS[name].read, path)


DAMAGE: dict[str, Callable[[bytes, Random], bytes]] = {
    "empty": lambda data, rng: b"",
    "zeros": lambda data, rng: bytes(len(data)),
    "noise": lambda data, rng: rng.randbytes(300),
    "nesting": lambda data, rng: b"[" * 100_000,
    "nested objects": lambda data, rng: b'{"a":' * 100_000,
    "null": lambda data, rng: b"null\n",
    "list": lambda data, rng: b"[]\n",
    "object": lambda data, rng: b"{}\n",
    "number": lambda data, rng: b"1e999\n",
    "long number": lambda data, rng: b"9" * 5000,
    "surrogate": lambda data, rng: b'"\\ud800"\n',
    "half": lambda data, rng: data[: len(data) // 2],
    "twice": lambda data, rng: data + data,
}


@pytest.mark.parametrize("kind", DAMAGE)
@pytest.mark.parametrize("name", READERS)
def test_damaged_content_is_answered(name: str, kind: str, tmp_path: Path) -> None:
    path = READERS[name].place(tmp_path)
    path.write_bytes(DAMAGE[kind](path.read_bytes(), Random(0)))
    answers(READERS[name].read, path)


@pytest.mark.parametrize("name", READERS)
def test_a_file_cut_short_anywhere_is_answered(name: str, tmp_path: Path) -> None:
    path = READERS[name].place(tmp_path)
    data = path.read_bytes()
    for place in range(0, len(data), max(1, len(data) // READERS[name].places)):
        path.write_bytes(data[:place])
        answers(READERS[name].read, path)


@pytest.mark.parametrize("name", READERS)
def test_flipped_bits_and_strange_bytes_are_answered(name: str, tmp_path: Path) -> None:
    path, rng = READERS[name].place(tmp_path), Random(name)
    data = path.read_bytes()
    for _ in range(READERS[name].places):
        damaged = bytearray(data)
        damaged[rng.randrange(len(data))] ^= 1 << rng.randrange(8)
        damaged[rng.randrange(len(data))] = rng.choice(b'\0\xff\x80"{[:,-9eE.\n')
        path.write_bytes(damaged)
        answers(READERS[name].read, path)
