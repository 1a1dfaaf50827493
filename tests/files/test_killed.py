"""Tests of processes killed at many points of a write: old or new content, and no lasting remains."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from foreride.files.writing import exchange, marker
from foreride.files.writing.atomic import write_text
from foreride.files.writing.folder import atomic_folder
from foreride.files.writing.scratch import is_scratch, old_name, parent_lock

WRITER = """
import sys
from pathlib import Path
from foreride.files.writing.atomic import write_text
from foreride.files.writing.folder import atomic_folder

place = Path(sys.argv[1])
print("ready", flush=True)
for number in range(10**9):
    with atomic_folder(place / "run", "run") as draft:
        draft.write("one", str(number) * 1000)
        draft.write("two", str(number) * 1000)
    write_text(place / "note.txt", str(number) * 1000)
"""


def killed(place: Path, after_s: float) -> None:
    """Run a process that writes into `place` until it is killed."""
    with subprocess.Popen([sys.executable, "-c", WRITER, str(place)], stdout=subprocess.PIPE) as process:
        assert process.stdout is not None
        process.stdout.readline()
        time.sleep(after_s)
        process.send_signal(signal.SIGKILL)


def test_old_or_new_is_there_after_a_kill(tmp_path: Path) -> None:
    killed(tmp_path, 0.5)
    for point in range(20):
        killed(tmp_path, 0.0037 * point)
        found = marker.verified(tmp_path / "run", "run")
        assert found["one"] == found["two"]
        assert len(set((tmp_path / "note.txt").read_text())) >= 1
    for name in ("run", "other"):
        with atomic_folder(tmp_path / name, "run") as draft:
            draft.write("one", "last")
    assert {path.name for path in tmp_path.iterdir()} == {"run", "other", "note.txt"}


def test_remains_are_removed_and_said_but_not_those_of_the_living(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    place = tmp_path / "place"
    place.mkdir()
    child = os.fork()
    if child == 0:
        with atomic_folder(place / "dead", "run") as draft:
            draft.write("half", "x")
            os.kill(os.getpid(), signal.SIGKILL)
    os.waitpid(child, 0)
    (left,) = place.iterdir()
    assert is_scratch(left.name)
    with atomic_folder(tmp_path / "living", "run") as draft:
        draft.write("half", "x")
        (scratch,) = (path for path in tmp_path.iterdir() if is_scratch(path.name))
        program = (
            "import sys; from pathlib import Path; from foreride.files.writing.atomic import write_text\n"
        )
        program += "write_text(Path(sys.argv[1]), 'x')"
        command = [sys.executable, "-c", program, str(tmp_path / "new.txt")]
        subprocess.run(command, check=True)
        assert scratch.exists()
    write_text(place / "new.txt", "x")
    assert [path.name for path in place.iterdir()] == ["new.txt"]
    assert str(left) in capsys.readouterr().err


def test_a_folder_moved_aside_is_put_back(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with atomic_folder(tmp_path / "in" / "run", "run") as draft:
        draft.write("one", "x")
    os.rename(tmp_path / "in" / "run", old_name(tmp_path / "in" / "run"))
    program = "import sys; from pathlib import Path; from foreride.files.writing.scratch import parent_lock\n"
    program += "with parent_lock(Path(sys.argv[1])): pass"
    command = [sys.executable, "-c", program, str(tmp_path / "in" / "x")]
    told = subprocess.run(command, check=True, capture_output=True, text=True).stderr
    assert "put back" in told
    assert marker.verified(tmp_path / "in" / "run", "run") == {"one": b"x"}


def test_a_failed_swap_leaves_the_old_folder(tmp_path: Path) -> None:
    (tmp_path / "old").mkdir()
    with pytest.raises(FileNotFoundError):
        exchange.step_aside(tmp_path / "none", tmp_path / "old")
    assert [path.name for path in tmp_path.iterdir()] == ["old"]
    with parent_lock(tmp_path / "x"):
        pass
