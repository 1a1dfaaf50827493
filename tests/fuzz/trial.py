"""One input to one reader, judged: a result or one line of InputError, in bounded time and memory."""

import os
import resource
import shutil
import signal
import sys
import tempfile
import traceback
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from types import FrameType

from foreride.files.errors import InputError
from tests.fuzz.arguments import ARGUMENTS
from tests.fuzz.readers import READERS
from tests.fuzz.sandbox import SCRATCH

CPU_S = 5.0
"""Longest time of the processor that a reader may take."""
GROWTH_MIB = 512
"""Most memory that one input may cost."""
LONGEST_LINE = 500
ROOT = Path(__file__).parents[2]
ALL = READERS | ARGUMENTS
"""Every reader, and the command line of every command."""


@dataclass(frozen=True)
class Finding:
    """Failure of a trial: kind (exception, message, slow, memory, noise, crash, hang), place and text."""

    reader: str
    kind: str
    place: str
    told: str

    @property
    def key(self) -> tuple[str, str, str]:
        """Findings of one key count as one."""
        return self.reader, self.kind, self.place


class _Slow(BaseException):
    """Raised by the clock within a reader; no handler of exceptions takes it for bad input."""


class Bench:
    """A folder with the valid input of one reader, whose file each trial replaces."""

    def __init__(self, name: str) -> None:
        self.name, self._reader = name, ALL[name]
        self._folder = Path(tempfile.mkdtemp(prefix=SCRATCH))
        self.path = self._reader.place(self._folder).resolve()
        self.valid = self.path.read_bytes()
        self._clock_ns = 10**18

    def close(self) -> None:
        """Remove the folder."""
        shutil.rmtree(self._folder, ignore_errors=True)

    def trial(self, data: bytes) -> Finding | None:
        """Put `data` in place of the valid file and read it; None where all is well."""
        self.path.write_bytes(data)
        self._clock_ns += 10**9  # readers that keep what they read must see that the file is another one
        os.utime(self.path, ns=(self._clock_ns, self._clock_ns))
        before = _peak_mib()
        try:
            with _limited():
                self._reader.read(self.path)
        except InputError as error:
            if told := _untold(str(error)):
                return self._finding("message", told, str(error))
        except _Slow as error:
            return self._finding("slow", ground_position(error), f"more than {CPU_S:g} s")
        except BaseException as error:
            return self._finding(
                "exception", f"{type(error).__name__} at {ground_position(error)}", str(error)
            )
        if (grown := _peak_mib() - before) > GROWTH_MIB:
            return self._finding("memory", "peak", f"{grown:.0f} MiB")
        return None

    def _finding(self, kind: str, place: str, told: str) -> Finding:
        return Finding(self.name, kind, place, told[:LONGEST_LINE])


@contextmanager
def _limited() -> Iterator[None]:
    def late(number: int, frame: FrameType | None) -> None:
        raise _Slow

    old = signal.signal(signal.SIGPROF, late)
    signal.setitimer(signal.ITIMER_PROF, CPU_S)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.signal(signal.SIGPROF, old)


def _untold(message: str) -> str:
    """What is wrong with an error's message; nothing where it is one short printable line."""
    if not message.strip():
        return "empty"
    if len(message) >= LONGEST_LINE:
        return f"{LONGEST_LINE} characters or more"
    return "" if message.isprintable() else "not one printable line"


def ground_position(error: BaseException) -> str:
    """The innermost line of this project's code that the error went through."""
    frames = traceback.extract_tb(error.__traceback__)
    own = [f for f in frames if Path(f.filename).is_relative_to(ROOT) and "tests/fuzz" not in f.filename]
    last = (own or frames)[-1]
    name = Path(last.filename)
    shown = name.relative_to(ROOT) if name.is_relative_to(ROOT) else name.name
    return f"{shown}:{last.lineno} {last.name}"


def _peak_mib() -> float:
    unit = 1 if sys.platform == "darwin" else 1024
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit / 2**20
