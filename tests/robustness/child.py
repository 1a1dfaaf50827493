"""Commands in forked processes of this one, whose imports are done: quick to start, and to be killed."""

import os
import signal
import sys
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tests.robustness.writers import Writer

EVENTS = frozenset({
    "open", "os.rename", "os.remove", "os.mkdir", "os.rmdir", "os.chmod", "os.link", "os.symlink",
    "os.truncate", "os.utime", "shutil.rmtree", "shutil.copyfile", "os.listdir", "os.scandir",
})  # fmt: skip
"""Audit events of the system calls after which a disk may hold something else."""


@dataclass(frozen=True)
class Ended:
    """status: exit code, or minus the signal. told: lines of stderr."""

    status: int
    told: list[str]


def start(
    arguments: list[str], folder: Path, before: Callable[[], None], stderr: int, prepare: Callable[[], None]
) -> int:
    """Fork a process that runs the command in the folder, its stderr a pipe; returns its number."""
    sys.stdout.flush()
    sys.stderr.flush()
    if pid := os.fork():
        return pid
    try:
        _redirect(stderr)
        os.chdir(folder)
        from foreride.scenarios.cli import main

        prepare()
        before()
        _open_streams()
        status = main(arguments)
    except SystemExit as error:
        status = error.code if isinstance(error.code, int) else 1
    except BaseException:
        import traceback

        traceback.print_exc()
        status = 70
    finally:
        for stream in (sys.stdout, sys.stderr):
            with suppress(OSError, ValueError, AttributeError):
                stream.flush()
        os._exit(status)


def run(
    writer: Writer,
    version: str,
    folder: Path,
    before: Callable[[], None] = lambda: None,
    kill_after_s: float | None = None,
) -> Ended:
    """The command on the inputs of that version, from start to end, or killed after so long."""
    told, stderr = os.pipe()
    os.set_blocking(told, False)
    pid = start(writer.command(version), folder, before, stderr, writer.prepare)
    os.close(stderr)
    if kill_after_s is not None:
        time.sleep(kill_after_s)
        os.kill(pid, signal.SIGKILL)
    _, code = os.waitpid(pid, 0)
    with open(told, "rb") as stream:
        text = (stream.read() or b"").decode(errors="replace")
    return Ended(os.waitstatus_to_exitcode(code), text.splitlines())


def _open_streams() -> None:
    """Open the streams as a new interpreter would: None where the system has closed them."""
    for name, number in (("stdout", 1), ("stderr", 2)):
        stream = None
        with suppress(OSError):
            stream = os.fdopen(number, "w", 1, closefd=False)
        setattr(sys, name, stream)


def _redirect(stderr: int) -> None:
    nothing = os.open(os.devnull, os.O_RDWR)
    for number, target in ((0, nothing), (1, nothing), (2, stderr)):
        os.dup2(target, number)


def killed_at(number: int, folder: Path) -> Callable[[], None]:
    """Have this process killed before its system call of that number that concerns the folder."""

    def die() -> None:
        os.kill(os.getpid(), signal.SIGKILL)

    return lambda: _watch(folder, lambda count: die() if count == number else None)


def counted(folder: Path, file: Path) -> Callable[[], None]:
    """Keep in a file how many such calls this process has made."""
    handle = os.open(file, os.O_RDWR | os.O_CREAT | os.O_TRUNC, 0o600)
    return lambda: _watch(folder, lambda count: os.pwrite(handle, f"{count:9}".encode(), 0))


def _watch(folder: Path, tell: Callable[[int], object]) -> None:
    """Count the calls, and those of fsync, which is no audit event."""
    place, count, here = os.path.realpath(folder), 0, os.getpid()

    def step() -> None:
        nonlocal count
        count += 1
        tell(count)

    def judge(event: str, given: tuple[Any, ...]) -> None:
        if (
            event not in EVENTS
            or os.getpid() != here
            or not given
            or not isinstance(given[0], str | bytes | Path)
        ):
            return
        if os.path.realpath(os.fsdecode(given[0])).startswith(place):
            step()

    def fsync(handle: int) -> None:
        step()
        plain(handle)
        step()

    plain, os.fsync = os.fsync, fsync
    sys.addaudithook(judge)
