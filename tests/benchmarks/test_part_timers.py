"""Tests of the CPU time by parts: every function that a table names exists, and each second counts once."""

from concurrent.futures import ThreadPoolExecutor
from pathlib import PurePath

import pytest

from benchmarks.loop_parts import PARTS, with_sums
from benchmarks.part_timers import OTHER, PartTimers, measured, places
from foreride.files.writing import names

JOINED = "foreride.files.writing.names:joined"


@pytest.mark.parametrize("name", [name for functions in PARTS.values() for name in functions])
def test_every_named_function_exists_and_is_used(name: str) -> None:
    assert places(name)


def test_a_nested_part_counts_its_time_for_itself_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    clock = iter(range(100))
    monkeypatch.setattr("benchmarks.part_timers.process_time", lambda: next(clock))
    timers = PartTimers()
    inner = timers.timed("inner", lambda: next(clock))
    timers.timed("outer", lambda: (inner(), inner()))()
    assert timers.seconds == {OTHER: 1, "outer": 3, "inner": 4}
    assert timers.calls == {"outer": 1, "inner": 2}


def test_functions_are_wrapped_in_every_module_while_a_measurement_lasts() -> None:
    unwrapped = names.joined
    with measured({"names": [JOINED]}) as timers:
        assert names.joined is not unwrapped
        names.joined(("a", "b"), ("a", "b"))
        assert ThreadPoolExecutor(1).submit(PurePath, "done").done()
    assert names.joined is unwrapped
    assert timers.calls == {"names": 1}


def test_a_group_of_parts_is_led_by_its_sum() -> None:
    assert with_sums({"plant: step": 1.0, "plant: state": 2.0, "loop": 4.0}) == {
        "plant": 3.0,
        "plant: step": 1.0,
        "plant: state": 2.0,
        "loop": 4.0,
    }
