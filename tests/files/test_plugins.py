"""Tests of registries open to installed packages."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from foreride.files import plugins
from foreride.files.errors import InputError
from foreride.files.plugins import Registry


def accept_number(name: str, value: Any) -> float:
    if not isinstance(value, float):
        raise InputError(f"must be a float, got {value!r}")
    return value


def registry() -> Registry[float]:
    return Registry("test.numbers", "number", {"one": 1.0}, accept_number)


@pytest.fixture(autouse=True)
def _entry_points_read_anew() -> Iterator[None]:
    plugins._installed.cache_clear()
    plugins._of_group.cache_clear()
    yield
    plugins._installed.cache_clear()
    plugins._of_group.cache_clear()


def install(folder: Path, package: str, code: str, *entries: str) -> None:
    """Lay out an installed package: a module and the metadata with its entry points."""
    folder.mkdir(exist_ok=True)
    (folder / f"{package}.py").write_text(code)
    info = folder / f"{package}-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {package}\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text("\n".join(["[test.numbers]", *entries]) + "\n")


def test_parts_are_own_installed_and_registered(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    install(tmp_path, "pack_two", "TWO = 2.0", "two = pack_two:TWO")
    monkeypatch.syspath_prepend(tmp_path)
    numbers = registry()
    numbers.register("three", 3.0)
    assert numbers.names() == ["one", "three", "two"]
    assert numbers.parts() == {"one": 1.0, "three": 3.0, "two": 2.0}
    assert numbers.find("four") is None


def test_what_does_not_load_stops_only_what_needs_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    install(tmp_path, "pack_exits", "import sys\nsys.exit(3)", "four = pack_exits:FOUR")
    install(tmp_path, "pack_text", "FIVE = 'text'", "five = pack_text:FIVE", "six = pack_text:SIX")
    monkeypatch.syspath_prepend(tmp_path)
    numbers = registry()
    for name, told in (
        ("four", r"^number four of pack_exits 1\.0: does not load \(SystemExit: 3 at pack_exits.py:2\)$"),
        ("five", r"^number five of pack_text 1\.0: must be a float, got 'text'$"),
        ("six", r"^number six of pack_text 1\.0: does not load \(AttributeError"),
    ):
        for _ in range(2):
            with pytest.raises(InputError, match=told):
                numbers.find(name)
    assert numbers.parts() == numbers.parts() == {"one": 1.0}
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 3
    assert all(line.endswith("it is left out") for line in lines)


def test_a_name_given_twice_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    install(tmp_path, "pack_a", "SEVEN = 7.0", "seven = pack_a:SEVEN")
    install(tmp_path, "pack_b", "SEVEN = 7.5", "seven = pack_b:SEVEN", "one = pack_b:SEVEN")
    monkeypatch.syspath_prepend(tmp_path)
    numbers = registry()
    with pytest.raises(InputError, match=r"number seven: is given by pack_[ab] 1.0 and pack_[ab] 1.0"):
        numbers.find("seven")
    with pytest.raises(InputError, match=r"number 'seven': the name is taken by pack_"):
        numbers.register("seven", 7.0)
    assert numbers.find("one") == 1.0
    assert (
        capsys.readouterr().err == "foreride: number one: is foreride's own; that of pack_b 1.0 is left out\n"
    )


def test_names_are_registered_once_unless_replaced() -> None:
    numbers = registry()
    numbers.register("two", 2.0)
    with pytest.raises(InputError, match="number 'two': the name is taken by this process"):
        numbers.register("two", 2.5)
    with pytest.raises(InputError, match="number 'two': must be a float, got 'x'"):
        numbers.register("two", "x", replace=True)
    numbers.register("two", 2.5, replace=True)
    assert numbers.find("two") == 2.5
    with pytest.raises(InputError, match="number 'one': the name is taken by foreride"):
        numbers.register("one", 1.5, replace=True)
    numbers.unregister("two")
    assert numbers.find("two") is None
