"""Fuzzing for hours: worker processes that are started anew after a crash, a hang or a loss of memory."""

import multiprocessing
import os
import resource
import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from multiprocessing.connection import Connection
from multiprocessing.context import ForkProcess
from pathlib import Path

from tests.fuzz.mutations import mutation
from tests.fuzz.sandbox import confine
from tests.fuzz.trial import Bench, Finding

HANG_S = 60.0
"""Longest time on the clock for one input, after which its process is killed."""
ROOM_GIB = 8
_FORK = multiprocessing.get_context("fork")


@dataclass
class Tally:
    """inputs: tried, by reader. found: the first input of each finding. times: how often each was found."""

    inputs: dict[str, int]
    found: dict[tuple[str, str, str], tuple[Finding, int]] = field(default_factory=dict)
    times: dict[tuple[str, str, str], int] = field(default_factory=dict)
    restarts: int = 0

    def add(self, finding: Finding, index: int) -> bool:
        """Count the finding; whether it is new."""
        self.times[finding.key] = self.times.get(finding.key, 0) + 1
        new = finding.key not in self.found
        if new:
            self.found[finding.key] = finding, index
        return new


def valid_inputs(names: Sequence[str]) -> dict[str, bytes]:
    """The undamaged file of each reader."""
    found = {}
    for name in names:
        bench = Bench(name)
        found[name] = bench.valid
        bench.close()
    return found


class Worker:
    """One process that goes through the inputs `first`, `first` + `step`, ... below `end` of every reader.

    The reader that has had the least time is next, so that fast ones get most inputs.
    """

    def __init__(self, seed: int, valid: dict[str, bytes], first: int, step: int, end: int) -> None:
        self.seed, self.valid, self.step, self.end = seed, valid, step, end
        self.names = list(valid)
        self.next = _FORK.RawArray("q", [first] * len(self.names))
        self.now = _FORK.RawValue("q", 0)  # place of the reader that is at work
        self._spent = _FORK.RawArray("d", [0.0] * len(self.names))
        self.start()

    def start(self) -> None:
        """Go on with the input after the last one."""
        self.inbox, outbox = _FORK.Pipe(duplex=False)
        self.process = ForkProcess(target=self._work, args=(outbox,), daemon=True)
        self.process.start()
        outbox.close()
        self._seen, self._moved = self.tried, time.monotonic()

    @property
    def tried(self) -> int:
        """How many inputs it has begun."""
        return sum(self.next) // self.step

    @property
    def done(self) -> bool:
        """Whether every reader has had all of its inputs."""
        return not self._open()

    def _open(self) -> list[int]:
        return [place for place, index in enumerate(self.next) if index < self.end]

    def hangs(self) -> bool:
        """Whether it has been at one input for too long."""
        if self.tried != self._seen:
            self._seen, self._moved = self.tried, time.monotonic()
        return time.monotonic() - self._moved > HANG_S

    def _work(self, outbox: Connection) -> None:
        _limit_memory()
        _silence()
        confine()
        benches: dict[str, Bench] = {}
        others = list(self.valid.values())
        while left := self._open():
            place = min(left, key=self._spent.__getitem__)
            name, index = self.names[place], self.next[place]
            if name not in benches:
                benches[name] = Bench(name)
            self.now.value, self.next[place] = place, index + self.step
            started = time.process_time()
            finding = benches[name].trial(mutation(self.seed, name, index, self.valid[name], others))
            self._spent[place] += time.process_time() - started
            if finding is not None:
                outbox.send((finding, index))
                if finding.kind in ("slow", "memory"):  # what it left behind would blur the next ones
                    return


def campaign(seed: int, valid: dict[str, bytes], seconds: float, jobs: int = 1, inputs: int = 2**60) -> Tally:
    """Try so many inputs a reader, at most for so long, in so many processes; returns what was found."""
    tally = Tally(dict.fromkeys(valid, 0))
    workers = [Worker(seed, valid, first, jobs, inputs) for first in range(jobs)]
    end = told = time.monotonic()
    end += seconds
    while time.monotonic() < end and any(w.process.is_alive() or not w.done for w in workers):
        time.sleep(0.1)
        for worker in workers:
            _tend(worker, tally)
        if time.monotonic() - told > 60:
            told = time.monotonic()
            tried = sum(worker.tried for worker in workers)
            print(f"{tried} inputs, {len(tally.found)} findings", flush=True)
    for worker in workers:
        worker.process.kill()
        worker.process.join()
        _collect(worker, tally)
    for place, name in enumerate(valid):
        tally.inputs[name] = sum((w.next[place] - first) // jobs for first, w in enumerate(workers))
    return tally


def _tend(worker: Worker, tally: Tally) -> None:
    _collect(worker, tally)
    hangs = worker.hangs()
    if hangs:
        worker.process.kill()
        worker.process.join()
    if worker.process.is_alive():
        return
    worker.process.join()
    _collect(worker, tally)
    if worker.process.exitcode:
        place = worker.now.value
        name, index = worker.names[place], worker.next[place] - worker.step
        kind = "hang" if hangs else "crash"
        tally.add(Finding(name, kind, f"exit code {worker.process.exitcode}", ""), index)
    if not worker.done:
        tally.restarts += 1
        worker.start()


def _collect(worker: Worker, tally: Tally) -> None:
    try:
        while worker.inbox.poll():
            finding, index = worker.inbox.recv()
            if tally.add(finding, index):
                print(f"{finding.reader}: {finding.kind} {finding.place}: {finding.told[:120]!r}", flush=True)
    except (EOFError, OSError):
        return


def _limit_memory() -> None:
    pages = int(Path("/proc/self/statm").read_text().split()[0]) if Path("/proc/self/statm").exists() else 0
    if pages:
        limit = pages * resource.getpagesize() + (ROOM_GIB << 30)
        resource.setrlimit(resource.RLIMIT_AS, (limit, limit))


def _silence() -> None:
    """Libraries in C write their warnings to the terminal."""
    nothing = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nothing, 1)
    os.dup2(nothing, 2)
