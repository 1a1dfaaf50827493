"""Cached object code is that of its source, whole, and not more than the cache holds."""

import os
from pathlib import Path

import pytest

from foreride.files import object_code as module
from foreride.files.object_code import object_code


@pytest.fixture
def kernels(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("FORERIDE_CACHE", str(tmp_path))
    return tmp_path / "kernels"


def _refuse() -> bytes:
    raise AssertionError("compiled although it is in the cache")


def test_code_is_compiled_once_for_each_source(kernels: Path) -> None:
    assert object_code((b"a", b"bc"), lambda: b"first") == b"first"
    assert object_code((b"a", b"bc"), _refuse) == b"first"
    assert object_code((b"ab", b"c"), lambda: b"second") == b"second"
    assert object_code((b"a",), lambda: b"third") == b"third"
    assert len(list(kernels.iterdir())) == 3


@pytest.mark.parametrize("damage", ["empty", "short", "changed", "code of another source", "a folder"])
def test_damaged_and_foreign_files_are_not_loaded(kernels: Path, damage: str) -> None:
    object_code((b"a",), lambda: b"right")
    (kept,) = kernels.iterdir()
    whole = kept.read_bytes()
    object_code((b"other",), lambda: b"wrong")
    (other,) = set(kernels.iterdir()) - {kept}
    kept.unlink()
    if damage == "a folder":
        kept.mkdir()
    else:
        versions = {
            "empty": b"",
            "short": whole[:-1],
            "changed": whole[:-1] + b"!",
            "code of another source": other.read_bytes(),
        }
        kept.write_bytes(versions[damage])
    assert object_code((b"a",), lambda: b"right") == b"right"
    if damage != "a folder":
        assert kept.read_bytes() == whole


def test_code_is_compiled_where_nothing_can_be_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "cached", lambda name: Path("/dev/null") / name)
    assert object_code((b"a",), lambda: b"code") == b"code"


def test_the_files_unused_for_longest_are_deleted(kernels: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "MAX_FILES", 3)
    for source in (b"1", b"2", b"3"):
        object_code((source,), lambda: b"code")
    for path in kernels.iterdir():
        os.utime(path, (1, 1))
    object_code((b"1",), _refuse)
    object_code((b"4",), lambda: b"code")
    object_code((b"5",), lambda: b"code")
    assert len(list(kernels.iterdir())) == 3
    for source in (b"1", b"4", b"5"):
        object_code((source,), _refuse)
