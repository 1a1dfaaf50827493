"""Tests of atomic file writing, through links and devices, with the umask's permissions."""

import os
import stat
import subprocess
import sys
import threading
from collections.abc import Iterator
from pathlib import Path

import pytest

from foreride.files.errors import InputError
from foreride.files.writing.atomic import replaced, write_bytes, write_text


@pytest.fixture
def private() -> Iterator[None]:
    before = os.umask(0o077)
    yield
    os.umask(before)


def test_text_replaces_the_old_file(tmp_path: Path) -> None:
    path = tmp_path / "deep" / "note.txt"
    write_text(path, "old")
    write_text(path, "für")
    assert path.read_text(encoding="utf-8") == "für"
    assert [p.name for p in path.parent.iterdir()] == ["note.txt"]


def test_new_files_obey_the_umask_and_old_ones_keep_their_mode(tmp_path: Path, private: None) -> None:
    path = tmp_path / "note.txt"
    write_text(path, "new")
    assert stat.S_IMODE(path.stat().st_mode) == 0o600
    path.chmod(0o640)
    write_text(path, "again")
    assert stat.S_IMODE(path.stat().st_mode) == 0o640


def test_a_link_is_followed(tmp_path: Path) -> None:
    (tmp_path / "there").mkdir()
    target, link = tmp_path / "there" / "real.txt", tmp_path / "link.txt"
    target.write_text("old")
    link.symlink_to(target)
    write_text(link, "new")
    assert link.is_symlink()
    assert target.read_text() == "new"
    assert [p.name for p in target.parent.iterdir()] == ["real.txt"]


def test_a_link_to_nothing_makes_its_target(tmp_path: Path) -> None:
    link = tmp_path / "link.txt"
    link.symlink_to("real.txt")
    write_text(link, "new")
    assert (tmp_path / "real.txt").read_text() == "new"
    assert link.is_symlink()


def test_a_device_stays_a_device(tmp_path: Path) -> None:
    if os.getuid() == 0:
        device = tmp_path / "null"
        os.mknod(device, 0o666 | stat.S_IFCHR, os.makedev(1, 3))
    else:
        device = Path("/dev/null")
    write_text(device, "gone")
    assert stat.S_ISCHR(device.stat().st_mode)


def test_a_pipe_is_written_to(tmp_path: Path) -> None:
    pipe, found = tmp_path / "pipe", []
    os.mkfifo(pipe)
    reader = threading.Thread(target=lambda: found.append(pipe.read_text()))
    reader.start()
    write_text(pipe, "through")
    reader.join(10)
    assert found == ["through"]
    assert stat.S_ISFIFO(pipe.stat().st_mode)


@pytest.mark.parametrize("name", ["/dev/stdout", "own"])
def test_own_output_is_added_to(tmp_path: Path, name: str) -> None:
    file = tmp_path / "own"
    program = "import sys; from pathlib import Path; from foreride.files.writing.atomic import write_text\n"
    program += "print('before'); write_text(Path(sys.argv[1]), 'this\\n'); print('after')"
    with file.open("w") as stream:
        place = name if name.startswith("/") else str(file)
        subprocess.run([sys.executable, "-c", program, place], stdout=stream, check=True)
    assert file.read_text() == "before\nthis\nafter\n"


def test_a_block_device_or_socket_is_refused(tmp_path: Path) -> None:
    import socket

    path = tmp_path / "socket"
    with socket.socket(socket.AF_UNIX) as served:
        served.bind(str(path))
        with pytest.raises(InputError, match="must be a file"):
            write_bytes(path, b"x")


def test_a_failure_names_the_file_and_its_size(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("mine")
    with pytest.raises(OSError, match="12 345 bytes to write") as caught:
        write_bytes(tmp_path / "file" / "inner", b"x" * 12345)
    assert caught.value.filename == str(tmp_path / "file" / "inner")


def test_a_library_writes_by_name(tmp_path: Path) -> None:
    path = tmp_path / "film.mp4"
    path.write_text("old")
    with pytest.raises(ZeroDivisionError), replaced(path) as scratch:
        scratch.write_text(str(1 / 0))
    assert path.read_text() == "old"
    with replaced(path) as scratch:
        assert scratch.suffix == ".mp4"
        scratch.write_text("new")
    assert path.read_text() == "new"
    assert [p.name for p in tmp_path.iterdir()] == ["film.mp4"]
