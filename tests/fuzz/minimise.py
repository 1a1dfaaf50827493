"""Delta debugging: the part of an input that is enough for the same finding."""

import multiprocessing
import time
from collections.abc import Callable

from tests.fuzz.trial import Bench, Finding

_FORK = multiprocessing.get_context("fork")
_TRIAL_S = 20.0


def minimised(finding: Finding, data: bytes, seconds: float = 20.0) -> bytes:
    """The shortest part of the input found within so long that still gives the same finding."""
    bench = Bench(finding.reader)
    try:
        return reduced(data, lambda less: _key(bench, less) == finding.key, seconds)
    finally:
        bench.close()


def reduced(data: bytes, fails: Callable[[bytes], bool], seconds: float) -> bytes:
    """Leave out ever smaller chunks as long as what is left fails (Zeller and Hildebrandt 2002, ddmin)."""
    end = time.monotonic() + seconds
    size = len(data) // 2
    while size >= 1:
        start, cut = 0, False
        while start < len(data):
            if time.monotonic() > end:
                return data
            less = data[:start] + data[start + size :]
            if fails(less):
                data, cut = less, True
            else:
                start += size
        if not cut or size > 1:
            size //= 2
    return data


def _key(bench: Bench, data: bytes) -> tuple[str, str, str] | None:
    """What the input gives, in a process of its own that may crash or hang."""
    inbox, outbox = _FORK.Pipe(duplex=False)

    def work() -> None:
        finding = bench.trial(data)
        outbox.send(finding and finding.key)

    process = _FORK.Process(target=work, daemon=True)
    process.start()
    outbox.close()
    process.join(_TRIAL_S)
    if process.is_alive():
        process.kill()
        process.join()
        return bench.name, "hang", f"exit code {process.exitcode}"
    if process.exitcode:
        return bench.name, "crash", f"exit code {process.exitcode}"
    found: tuple[str, str, str] | None = inbox.recv()
    return found
