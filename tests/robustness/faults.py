"""Systems that refuse: full and read-only disks, little memory, closed streams.

`python -m tests.robustness.faults`: whatever a command meets, it ends with one line and an exit code, and
leaves old or whole new files.
"""

import argparse
import ctypes
import os
import resource
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

from tests.robustness.child import Ended, run
from tests.robustness.kill_points import Stage, stage, warm
from tests.robustness.state import problems, scratch_in
from tests.robustness.writers import SLOW, WORK, WRITERS, Writer, fresh

ROOT = Path(__file__).parents[2]


@dataclass(frozen=True)
class Fault:
    """limit: what is done in the process of the command. ends: exit codes that are right.

    over: whether an older result is there.
    """

    limit: Callable[[Path], None]
    ends: tuple[int, ...] = (0, 2)
    over: bool = True


def _soft(kind: int, value: int) -> None:
    resource.setrlimit(kind, (value, resource.getrlimit(kind)[1]))


def file_size(limit: int) -> Fault:
    """No file may grow beyond so many bytes."""
    return Fault(lambda work: _soft(resource.RLIMIT_FSIZE, limit))


def memory(more_mib: int) -> Fault:
    """So much more than what the process has at its start."""

    def limit(work: Path) -> None:
        pages = int(Path("/proc/self/statm").read_text().split()[0])
        _soft(resource.RLIMIT_AS, pages * resource.getpagesize() + (more_mib << 20))

    return Fault(limit, (0, 2, 70))  # 70: Python itself could not go on


def _read_only(work: Path) -> None:
    """No folder may be written to."""
    for folder in (work, *(path for path in work.rglob("*") if path.is_dir())):
        folder.chmod(0o555)
    if os.getuid() == 0:
        _without_override()


def _without_override() -> None:
    """Take from root what lets it pass by permissions (CAP_DAC_OVERRIDE and the two after it)."""
    libc, header = ctypes.CDLL(None, use_errno=True), (ctypes.c_uint32 * 2)(0x20080522, 0)
    sets = (ctypes.c_uint32 * 6)()  # effective, permitted, inheritable; twice 32 of each
    libc.capget(header, sets)
    sets[0] &= ~0b1110
    sets[1] &= ~0b1110
    if libc.capset(header, sets):
        raise OSError(ctypes.get_errno(), "capset")


def _few_files(work: Path) -> None:
    _soft(resource.RLIMIT_NOFILE, len(os.listdir("/proc/self/fd")) + 2)


def _closed(number: int) -> Fault:
    return Fault(lambda work: os.close(number), (0, 1, 2))


def _full_output(work: Path) -> None:
    os.dup2(os.open("/dev/full", os.O_WRONLY), 1)


def _broken_pipe(work: Path) -> None:
    reader, writer = os.pipe()
    os.dup2(writer, 1)
    os.close(reader)
    os.close(writer)


def _private(work: Path) -> None:
    os.umask(0o077)


FAULTS: dict[str, Fault] = {
    **{f"files of {size} bytes at most": file_size(size) for size in (0, 100, 3000, 30_000)},
    **{f"{mib} MiB of memory": memory(mib) for mib in (1, 30, 150)},
    "read-only": Fault(_read_only),
    "few open files": Fault(_few_files),
    "stdin closed": _closed(0),
    "stdout closed": _closed(1),
    "stderr closed": _closed(2),
    "stdout full": Fault(_full_output, (0, 1, 2)),
    "stdout a broken pipe": Fault(_broken_pipe, (0, 1, 2, 141)),  # as a shell tells of SIGPIPE
    "umask 077": Fault(_private, (0,), over=False),
}
ENVIRONMENTS: dict[str, dict[str, str | None]] = {
    "no home": {"HOME": None, "XDG_CACHE_HOME": None, "FORERIDE_CACHE": None},
    "home that is not there": {"HOME": "/nowhere", "XDG_CACHE_HOME": None, "FORERIDE_CACHE": None},
    "C locale": {"LC_ALL": "C", "LANG": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"},
}


def trial(staged: Stage, fault: Fault) -> list[str]:
    """What is wrong when the command meets the fault, and in its next run without."""
    work = staged.place / WORK
    _writable(work)
    fresh(work, staged.start if fault.over else staged.place / "empty")
    ended = run(staged.writer, "new", work, lambda: fault.limit(work))
    _writable(work)
    before = staged.before if fault.over else {}
    told = _wrong(ended, fault.ends) + problems(work, before, staged.after)
    told += [f"{name} is still there" for name in scratch_in(work)]
    if fault is FAULTS["umask 077"]:
        told += [f"{path.name}: open to others" for path in _new(work) if path.stat().st_mode & 0o077]
    ended = run(staged.writer, "new", work)
    return told + [f"next run: {one}" for one in _wrong(ended, (0,))]


def _wrong(ended: Ended, ends: tuple[int, ...]) -> list[str]:
    """What is wrong with how a command ended."""
    lines = [line for line in ended.told if line.strip()]
    if ended.status not in ends:
        return [f"exit code {ended.status}: {' | '.join(lines)[-300:]}"]
    if any(line.startswith("Traceback") for line in lines):
        return [f"traceback: {' | '.join(lines)[-300:]}"]
    if ended.status in (2, 70) and (len(lines) > 1 or not all(map(str.isprintable, lines))):
        return [f"{len(lines)} lines: {' | '.join(lines)[:300]}"]
    return []


def _new(work: Path) -> list[Path]:
    return [path for path in work.rglob("*") if path.is_file() and "cache" not in path.parts]


def _writable(work: Path) -> None:
    if work.is_dir():
        for folder in (work, *(path for path in work.rglob("*") if path.is_dir())):
            folder.chmod(0o755)


@contextmanager
def small_disk(work: Path, size: str) -> Iterator[bool]:
    """Mount a disk of that size at the folder, if the system lets this process; whether it did."""
    work.mkdir(exist_ok=True)
    mount = ["mount", "-t", "tmpfs", "-o", f"size={size}", "tmpfs", str(work)]
    allowed = False
    with suppress(OSError):
        allowed = os.getuid() == 0 and subprocess.run(mount, capture_output=True).returncode == 0
    try:
        yield allowed
    finally:
        if allowed:
            subprocess.run(["umount", "-l", str(work)], check=True)


def full_disk(staged: Stage, size: str) -> list[str] | None:
    """The command on a small disk; None where none can be mounted."""
    work = staged.place / WORK
    fresh(work, staged.start)
    with small_disk(work, size) as allowed:
        if not allowed:
            return None
        ended = run(staged.writer, "new", work)
        told = problems(work, {}, staged.after)
        return _wrong(ended, (0, 2)) + told + [f"{name} is still there" for name in scratch_in(work)]


def environment(staged: Stage, changes: dict[str, str | None]) -> list[str]:
    """The command in a new interpreter with these variables changed (None: without)."""
    work = staged.place / WORK
    fresh(work, staged.start)
    variables = {**os.environ, "PYTHONPATH": str(ROOT)}
    variables = {key: value for key, value in variables.items() if changes.get(key, value) is not None}
    variables |= {key: value for key, value in changes.items() if value is not None}
    command = [sys.executable, "-m", "foreride.scenarios.cli", *staged.writer.command("new")]
    done = subprocess.run(command, cwd=work, env=variables, capture_output=True, text=True, errors="replace")
    ended = Ended(done.returncode, done.stderr.splitlines())
    return _wrong(ended, (0,)) + problems(work, staged.before, staged.after)


def main() -> int:
    """Try all faults on all commands, print what is wrong; 1 where anything is."""
    parser = argparse.ArgumentParser(prog="python -m tests.robustness.faults", description=__doc__)
    quick = [name for name in WRITERS if name not in SLOW]
    parser.add_argument("--commands", metavar="A,B,...", help=f"default: {', '.join(quick)}")
    parser.add_argument("--faults", metavar="A,B,...", help="default: all")
    arguments = parser.parse_args()
    tried = wrong = 0
    with tempfile.TemporaryDirectory(prefix="foreride-faults-") as folder:
        place = Path(folder)
        place.chmod(0o755)
        os.environ["FORERIDE_CACHE"] = str(place / WORK / "cache")
        names = arguments.commands.split(",") if arguments.commands else quick
        warm(place, names)
        for name in names:
            for fault, told in trials(WRITERS[name], place, arguments.faults):
                tried, wrong = tried + 1, wrong + bool(told)
                for line in told:
                    print(f"{name}, {fault}: {line}", flush=True)
            print(f"{name}: done", flush=True)
    print(f"{tried} faults, {wrong} with findings")
    return int(wrong > 0)


def trials(writer: Writer, place: Path, chosen: str | None = None) -> Iterator[tuple[str, list[str]]]:
    """All faults of one command, over an old result, with what is wrong."""
    for inner in ("start", WORK):
        _writable(place / inner)
        (place / "empty").mkdir(exist_ok=True)
        fresh(place / inner, place / "empty")
    staged = stage(writer, place, over=True)
    wanted = chosen.split(",") if chosen else [*FAULTS, *ENVIRONMENTS, "disk of 16k", "disk of 200k"]
    for name in wanted:
        if name in FAULTS:
            yield name, trial(staged, FAULTS[name])
        elif name in ENVIRONMENTS:
            yield name, environment(staged, ENVIRONMENTS[name])
        elif (told := full_disk(staged, name.removeprefix("disk of "))) is not None:
            yield name, told


if __name__ == "__main__":
    sys.exit(main())
