from pathlib import Path

import pytest

from files.atomic import atomic_folder, write_text


def test_text_replaces_the_old_file(tmp_path: Path) -> None:
    path = tmp_path / "deep" / "note.txt"
    write_text(path, "old")
    write_text(path, "für")
    assert path.read_text(encoding="utf-8") == "für"
    assert [p.name for p in path.parent.iterdir()] == ["note.txt"]


def test_a_failed_folder_leaves_the_old_one(tmp_path: Path) -> None:
    path = tmp_path / "run"
    with atomic_folder(path) as folder:
        (folder / "a").write_text("1")
    with pytest.raises(ZeroDivisionError), atomic_folder(path) as folder:
        (folder / "b").write_text(str(1 / 0))
    assert [p.name for p in path.iterdir()] == ["a"]
    assert [p.name for p in tmp_path.iterdir()] == ["run"]


def test_a_complete_folder_replaces_the_old_one(tmp_path: Path) -> None:
    path = tmp_path / "run"
    for name in ("a", "b"):
        with atomic_folder(path) as folder:
            (folder / name).write_text(name)
    assert [p.name for p in path.iterdir()] == ["b"]
    assert [p.name for p in tmp_path.iterdir()] == ["run"]
