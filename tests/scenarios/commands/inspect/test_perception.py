"""Tests of `foreride perception`: selection of roads, and rejected options."""

import argparse
from pathlib import Path

import pytest

from foreride.scenarios.cases import Case
from foreride.scenarios.cli import main
from foreride.scenarios.commands.inspect import perception

SHORT = """
title: A short drive
speed_kmh: 40
road:
  length_m: 16
vehicle: {model: quarter}
"""


def groups(*words: str) -> list[tuple[str, list[Case]]]:
    """Groups of cases that the command would simulate."""
    parser = argparse.ArgumentParser()
    perception.configure(parser)
    arguments = parser.parse_args(list(words))
    return (perception._courses if arguments.courses else perception._scenarios)(arguments)


@pytest.mark.parametrize(("events", "roads"), [(5, [5]), (10, [10]), (23, [10, 10, 3])])
def test_as_many_obstacles_are_met_as_asked_for(events: int, roads: list[int]) -> None:
    ((name, cases),) = groups("--courses", "bumps", "--events", str(events), "--seeds", "7")
    assert name == "bumps day"
    assert [len(case.scenario.road.features) for case in cases] == roads
    assert [case.seed for case in cases] == list(range(7, 7 + len(roads)))


def test_a_hundred_unless_told_otherwise_each_course_in_each_look() -> None:
    named = groups("--courses", "bumps,potholes", "--looks", "day,rain")
    assert [name for name, _ in named] == ["bumps day", "bumps rain", "potholes day", "potholes rain"]
    assert {len(cases) for _, cases in named} == {10}


def test_two_files_of_one_name_are_two_rows(tmp_path: Path) -> None:
    paths = [tmp_path / folder / "short.yaml" for folder in "ab"]
    for path, length_m in zip(paths, (16, 20), strict=True):
        path.parent.mkdir()
        path.write_text(SHORT.replace("16", str(length_m)))
    named = groups(*map(str, paths))
    assert [name for name, _ in named] == ["short", "short"]
    assert [case.scenario.road.length_m for _, (case,) in named] == [16.0, 20.0]


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["mixed_40", "--braking", "3"], "--braking must come with --courses"),
        (["mixed_40", "--looks", "rain", "--events", "5"], "--looks, --events must come with --courses"),
        (["mixed_40", "--grade", "0"], "--grade must come with --courses"),
        (["--courses", "bumps", "--seeds", "1,2"], "--seeds must be one with --courses"),
        (["--courses", "bumps", "--events", "0"], "--events must lie in 1"),
    ],
)
def test_what_would_be_ignored_is_refused(
    words: list[str], told: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["perception", *words]) == 2
    assert told in " ".join(capsys.readouterr().err.split())
