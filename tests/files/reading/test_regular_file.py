"""Reading of data files: only regular files of bounded size, every failure in one line."""

import os
from pathlib import Path

import pytest

from foreride.files.errors import SHOWN_LENGTH, InputError, printable, shown
from foreride.files.reading.regular_file import read_bytes, read_text, reading


def refusal(path: Path | str, **options: int) -> str:
    with pytest.raises(InputError) as error:
        read_text(path, **options)
    assert "\n" not in str(error.value)
    return str(error.value)


def test_line_ends_become_newlines(tmp_path: Path) -> None:
    (tmp_path / "a.txt").write_bytes("ä\r\nb\rc\n".encode())
    assert read_text(tmp_path / "a.txt") == "ä\nb\nc\n"


def test_a_pipe_is_refused_without_waiting_for_its_other_end(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    assert "must be a regular file, not a pipe" in refusal(tmp_path / "pipe")


@pytest.mark.parametrize(("place", "kind"), [("/dev/zero", "a device"), (".", "a folder")])
def test_only_regular_files_are_read(place: str, kind: str) -> None:
    assert f"must be a regular file, not {kind}" in refusal(place)


def test_a_file_beyond_its_limit_is_refused(tmp_path: Path) -> None:
    (tmp_path / "big").write_bytes(bytes(11))
    assert "must be at most 10 bytes large" in refusal(tmp_path / "big", limit=10)
    assert len(read_bytes(tmp_path / "big", limit=11)) == 11


@pytest.mark.parametrize(
    ("data", "told"), [(b"a\0b", "holds NUL characters"), (b"\xff\xfe", "is not UTF-8 text")]
)
def test_what_is_no_text_is_refused(tmp_path: Path, data: bytes, told: str) -> None:
    (tmp_path / "a.txt").write_bytes(data)
    assert told in refusal(tmp_path / "a.txt")


@pytest.mark.parametrize("name", ["nowhere", "line\nbreak", "not-utf8-\udcff", "nul\0byte"])
def test_names_of_any_characters_are_told_in_one_printable_line(name: str) -> None:
    assert refusal(name).isprintable()


@pytest.mark.parametrize(
    "error",
    [
        MemoryError(),
        RecursionError(),
        OverflowError("x"),
        KeyError("k"),
        OSError(5, "I/O"),
        ValueError("a\nb"),
    ],
)
def test_any_failure_of_reading_is_bad_input(error: Exception) -> None:
    with pytest.raises(InputError, match=r"^a\.yaml: ") as told, reading("a.yaml"):
        raise error
    assert str(told.value).isprintable()


def test_bad_input_is_told_as_it_was() -> None:
    with pytest.raises(InputError, match=r"^b: wrong$"), reading("a.yaml"):
        raise InputError("b: wrong")


def test_values_are_shown_in_bounded_time_and_length() -> None:
    nested: list = []
    for _ in range(100):
        nested = [nested] * 10  # 10^100 items when written out
    for value in (nested, 10**100_000, "x" * 10**6, dict.fromkeys(range(1000), nested), "\ud800\0\n"):
        assert len(shown(value)) <= SHOWN_LENGTH + 20
        assert shown(value).isprintable()
    assert shown(None) == "nothing"
    assert shown("a") == "'a'"


def test_printable_keeps_what_can_be_shown() -> None:
    assert printable("Straße 1\n2") == "Straße 1 2"
    assert printable("\udcff") == "\\udcff"
