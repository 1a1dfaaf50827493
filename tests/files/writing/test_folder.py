"""Tests of output folders: foreign files are never replaced, and old or new content is always there."""

import multiprocessing
import os
import stat
from pathlib import Path

import pytest

from foreride.files.errors import InputError
from foreride.files.writing import exchange, marker
from foreride.files.writing.folder import atomic_folder, check_folder, claim


def write(path: Path, kind: str = "run", **files: str) -> None:
    with atomic_folder(path, kind) as draft:
        for name, text in files.items():
            draft.write(name, text)


def names(folder: Path) -> set[str]:
    return {path.name for path in folder.iterdir()}


def test_a_failed_folder_leaves_the_old_one(tmp_path: Path) -> None:
    path = tmp_path / "run"
    write(path, a="1")
    with pytest.raises(ZeroDivisionError), atomic_folder(path, "run") as draft:
        draft.write("b", str(1 / 0))
    assert names(path) == {"a", "foreride.json"}
    assert names(tmp_path) == {"run"}


@pytest.mark.parametrize("swaps", [True, False])
def test_a_complete_folder_replaces_the_old_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, swaps: bool
) -> None:
    if not swaps:
        monkeypatch.setattr(exchange, "exchange", lambda one, other: False)
    for name in ("a", "b"):
        write(tmp_path / "run", **{name: name})
    assert names(tmp_path / "run") == {"b", "foreride.json"}
    assert names(tmp_path) == {"run"}


def test_files_of_others_are_neither_replaced_nor_lost(tmp_path: Path) -> None:
    path = tmp_path / "run"
    write(path, a="1")
    (path / "notes" / "deep").mkdir(parents=True)
    (path / "notes" / "deep" / "mine.txt").write_text("mine")
    (path / "link").symlink_to("nowhere")
    (path / "report.html").write_text("made of the old run")
    write(path, b="2")
    assert names(path) == {"b", "notes", "link", "foreride.json"}
    assert (path / "notes" / "deep" / "mine.txt").read_text() == "mine"


@pytest.mark.parametrize("there", ["thesis.txt", ".hidden", "folder/inner.txt", "foreride.json"])
def test_a_folder_of_others_is_refused_before_any_work(tmp_path: Path, there: str) -> None:
    path = tmp_path / "victim"
    (path / there).parent.mkdir(parents=True)
    (path / there).write_text("mine")
    with pytest.raises(InputError, match="victim") as caught, atomic_folder(path, "run"):
        raise AssertionError("work was done")
    assert "\n" not in str(caught.value)
    with pytest.raises(InputError, match="victim"):
        claim(path, "runs")
    assert (path / there).read_text() == "mine"
    assert names(tmp_path) == {"victim"}


def test_a_folder_of_another_kind_is_refused(tmp_path: Path) -> None:
    write(tmp_path / "run", a="1")
    with pytest.raises(InputError, match="kind"):
        check_folder(tmp_path / "run", "render")
    with pytest.raises(InputError, match="kind"):
        claim(tmp_path / "run", "sweep")


def test_the_working_folder_its_parents_and_home_are_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "in").mkdir()
    monkeypatch.chdir(tmp_path / "in")
    for path in (Path("."), Path(".."), Path("/"), Path.home(), Path("../in")):
        with pytest.raises(InputError, match="must not be"):
            check_folder(path, "run")


def test_a_file_in_the_way_is_refused(tmp_path: Path) -> None:
    (tmp_path / "run").write_text("mine")
    with pytest.raises(InputError, match="a file is there"):
        check_folder(tmp_path / "run", "run")


def test_a_link_to_a_folder_is_followed(tmp_path: Path) -> None:
    write(tmp_path / "real", a="1")
    (tmp_path / "link").symlink_to("real")
    write(tmp_path / "link", b="2")
    assert (tmp_path / "link").is_symlink()
    assert names(tmp_path / "real") == {"b", "foreride.json"}


def test_new_folders_obey_the_umask(tmp_path: Path) -> None:
    before = os.umask(0o077)
    try:
        write(tmp_path / "run", a="1")
    finally:
        os.umask(before)
    assert stat.S_IMODE((tmp_path / "run").stat().st_mode) == 0o700
    assert stat.S_IMODE((tmp_path / "run" / "a").stat().st_mode) == 0o600


def test_a_claimed_folder_is_added_to(tmp_path: Path) -> None:
    claim(tmp_path / "runs", "runs")
    (tmp_path / "runs" / "comparison.json").write_text("{}")
    claim(tmp_path / "runs", "runs")
    assert names(tmp_path / "runs") == {"foreride.json", "comparison.json"}


def test_a_folder_of_nothing_but_own_folders_may_be_claimed(tmp_path: Path) -> None:
    write(tmp_path / "runs" / "one", a="1")
    claim(tmp_path / "runs", "runs")
    assert names(tmp_path / "runs") == {"one", "foreride.json"}


def test_every_flipped_bit_is_found(tmp_path: Path) -> None:
    path = tmp_path / "run"
    write(path, data="ab")
    whole = (path / "data").read_bytes()
    assert marker.verified(path, "run") == {"data": whole}
    for bit in range(8 * len(whole)):
        flipped = bytearray(whole)
        flipped[bit // 8] ^= 1 << bit % 8
        (path / "data").write_bytes(flipped)
        with pytest.raises(InputError, match="data: is damaged"):
            marker.verified(path, "run")


def test_a_marker_names_no_file_outside_its_folder(tmp_path: Path) -> None:
    write(tmp_path / "run", a="1")
    for name in ("../secret", "/etc/passwd", ""):
        text = marker.Marker("run", {name: "0" * 64}).to_json()
        (tmp_path / "run" / "foreride.json").write_text(text)
        with pytest.raises(InputError, match="is damaged"):
            marker.verified(tmp_path / "run", "run")


def _write_often(path: Path, writer: int) -> None:
    for number in range(50):
        write(path, writer=f"{writer} {number}", same=f"{writer} {number}")


def test_several_writers_lose_no_write_and_a_reader_always_finds_a_whole_folder(tmp_path: Path) -> None:
    path = tmp_path / "run"
    write(path, writer="first", same="first")
    context = multiprocessing.get_context("fork")
    writers = [context.Process(target=_write_often, args=(path, writer)) for writer in range(4)]
    for process in writers:
        process.start()
    looks = 0
    while any(process.is_alive() for process in writers):
        found = marker.verified(path, "run")
        assert found["writer"] == found["same"]
        looks += 1
    assert [process.exitcode for process in writers] == [0] * 4
    assert looks > 10
    assert names(tmp_path) == {"run"}
