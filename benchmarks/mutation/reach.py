"""Record of the functions that each test executes, and of the test's processor time.

A test file runs in a process of its own, so that nothing which an earlier file left in a cache hides a call.
Tests that fail while they are recorded, or that take longer than `LONGEST_TEST_S`, judge no mutant.
"""

import hashlib
import json
import signal
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from types import CodeType, FrameType
from typing import Any

import pytest

from benchmarks.mutation.judge import in_child

FILE_LIMIT_S, LONGEST_TEST_S = 600.0, 5.0
"""Processor time of a test file and of a test while they are recorded, which takes up to twice the time."""


@dataclass(frozen=True)
class TestReach:
    """One test: its name in pytest, its processor time and the functions `file:name` that it executes."""

    __test__ = False
    name: str
    seconds: float
    functions: frozenset[str]

    @property
    def file(self) -> str:
        """Test file, relative to the repository."""
        return self.name.split("::")[0]


class _Recorder:
    """Pytest plugin that records the tests which pass."""

    def __init__(self, folder: Path) -> None:
        self._folder = str(folder) + "/"
        self._failed: set[str] = set()
        self.tests: list[TestReach] = []

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Iterator[None]:
        """Trace the calls of one test with its fixtures."""
        codes: set[CodeType] = set()

        def trace(frame: FrameType, event: str, argument: Any) -> None:
            codes.add(frame.f_code)

        signal.signal(signal.SIGPROF, _stop)
        start = time.process_time()
        sys.settrace(trace)
        signal.setitimer(signal.ITIMER_PROF, LONGEST_TEST_S)
        try:
            return (yield)
        finally:
            signal.setitimer(signal.ITIMER_PROF, 0.0)
            sys.settrace(None)
            seconds = time.process_time() - start
            if item.nodeid not in self._failed:
                self.tests.append(TestReach(item.nodeid, seconds, self._names(codes)))

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Note failed tests."""
        if report.failed:
            self._failed.add(report.nodeid)

    def _names(self, codes: set[CodeType]) -> frozenset[str]:
        own = [code for code in codes if code.co_filename.startswith(self._folder)]
        return frozenset(
            f"{code.co_filename.removeprefix(self._folder)}:{code.co_qualname.split('.<locals>')[0]}"
            for code in own
        )


def _stop(number: int, frame: FrameType | None) -> None:
    raise TimeoutError("the test takes too long to judge mutants")


def record(folder: Path, file: str, out: Path, compiled: bool = True) -> None:
    """Record the tests of a file with a hash of it and of all that they execute, as a line of the records."""
    recorder = _Recorder(folder)

    def write() -> None:
        rows = [asdict(test) | {"functions": sorted(test.functions)} for test in recorder.tests]
        line = {
            "file": file,
            "compiled": compiled,
            "hash": _hash(folder, file, recorder.tests),
            "tests": rows,
        }
        with out.open("a") as stream:
            stream.write(json.dumps(line) + "\n")

    in_child(folder, [file], FILE_LIMIT_S, compiled, recorder, write)


def recorded(folder: Path, files: Sequence[str], out: Path, compiled: bool = True) -> list[TestReach]:
    """Records of test files; those that are missing or out of date are made."""
    known = _records(folder, out)
    for file in files:
        if (file, compiled) not in known:
            record(folder, file, out, compiled)
    records = _records(folder, out)
    return [test for file in files for test in records.get((file, compiled), [])]


def _records(folder: Path, out: Path) -> dict[tuple[str, bool], list[TestReach]]:
    """Records by test file, with and without compilation, of files that are as they were."""
    found = {}
    for row in map(json.loads, out.read_text().splitlines() if out.exists() else ()):
        tests = [TestReach(one["name"], one["seconds"], frozenset(one["functions"])) for one in row["tests"]]
        if row["hash"] == _hash(folder, row["file"], tests):
            found[row["file"], row["compiled"]] = tests
    return found


def _hash(folder: Path, file: str, tests: Sequence[TestReach]) -> str:
    """Hash of a test file and of the files whose functions its tests execute."""
    files = {file} | {name.split(":")[0] for test in tests for name in test.functions}
    texts = [(folder / name).read_bytes() if (folder / name).exists() else b"" for name in sorted(files)]
    return hashlib.sha256(b"\0".join(texts)).hexdigest()[:16]
