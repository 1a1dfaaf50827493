"""The fuzzer finds what it is for: exceptions, long messages, slow, hungry, crashing and hanging readers."""

import faulthandler
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from foreride.files.errors import InputError
from tests.fuzz import campaign as campaigns
from tests.fuzz import trees
from tests.fuzz import trial as trials
from tests.fuzz.minimise import minimised, reduced
from tests.fuzz.mutations import mutation
from tests.fuzz.reader import Reader
from tests.fuzz.trial import ALL, ROOT, Bench

INPUTS = 50
VALID = b"one: 1\ntwo: [2, 3]\nthree: {four: text}\n"


def place(folder: Path) -> Path:
    (folder / "file").write_bytes(VALID)
    return folder / "file"


@pytest.fixture
def reader(monkeypatch: pytest.MonkeyPatch) -> Callable[[Callable[[bytes], object]], Bench]:
    """Make a bench for a reader of bytes."""

    def make(read: Callable[[bytes], object]) -> Bench:
        monkeypatch.setitem(trials.ALL, "mine", Reader(place, lambda path: read(path.read_bytes())))
        return Bench("mine")

    return make


def refuse(data: bytes) -> None:
    raise InputError("file: must be empty")


def fail(data: bytes) -> None:
    raise KeyError("x")


def linger(data: bytes) -> None:
    while True:
        pass


@pytest.mark.parametrize(
    ("read", "kind"), [(refuse, None), (len, None), (fail, "exception"), (linger, "slow")]
)
def test_a_trial_tells_good_answers_from_bad_ones(reader, read, kind, monkeypatch) -> None:  # type: ignore[no-untyped-def]
    monkeypatch.setattr(trials, "CPU_S", 0.05)
    finding = reader(read).trial(b"x")
    assert (finding and finding.kind) == kind


def test_inputs_are_the_same_in_every_process_and_mostly_differ() -> None:
    inputs = [mutation(1, "x", index, VALID, [b"other"]) for index in range(200)]
    assert inputs == [mutation(1, "x", index, VALID, [b"other"]) for index in range(200)]
    assert len(set(inputs)) > 150


def test_structures_change_one_document_or_one_line() -> None:
    from random import Random

    lines = b'{"a": 1}\n{"b": 2}\n{"c": 3}'
    for seed in range(50):
        changed = trees.mutated(Random(seed), lines)
        assert changed is not None
        assert sum(line in changed.split(b"\n") for line in lines.split(b"\n")) >= 2
    assert trees.mutated(Random(0), b"\x89PNG\r\n") is None


def test_what_is_found_is_reduced_to_what_it_needs() -> None:
    assert (
        reduced(b"a lot of text with a < and a > in it", lambda data: b"<" in data and b">" in data, 10)
        == b"<>"
    )


def test_crashes_and_hangs_are_survived_named_and_minimised(reader, monkeypatch) -> None:  # type: ignore[no-untyped-def]
    monkeypatch.setattr(campaigns, "HANG_S", 0.5)

    def read(data: bytes) -> None:
        if b"\0" in data:
            faulthandler.disable()  # a crash on purpose needs no traceback
            os.kill(os.getpid(), signal.SIGSEGV)
        if data == b"":
            signal.signal(signal.SIGPROF, signal.SIG_IGN)
            time.sleep(60)

    bench = reader(read)
    tally = campaigns.campaign(0, {"mine": bench.valid}, 60, jobs=2, inputs=300)
    assert tally.inputs == {"mine": 300}
    assert {kind for _, kind, _ in tally.found} == {"crash", "hang"}
    finding, index = next(one for one in tally.found.values() if one[0].kind == "crash")
    data = mutation(0, "mine", index, VALID, [VALID])
    small = minimised(finding, data, seconds=2)
    assert b"\0" in small
    assert len(small) < len(data)


def test_every_reader_and_command_line_answers_damaged_input(tmp_path: Path) -> None:
    """`INPUTS` mutations of each valid file and argument vector, the same in every run."""
    command = [sys.executable, "-m", "tests.fuzz", "--inputs", str(INPUTS), "--minutes", "15", "--jobs", "2"]
    done = subprocess.run([*command, "--out", tmp_path], cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    assert f"{len(ALL) * INPUTS} inputs, 0 findings" in done.stdout
