"""Tests of the validation command: rows, verdicts, exit code; and that all checks pass."""

import json
import math

import pytest

from foreride.scenarios.cli import main
from foreride.scenarios.validation import areas, published
from foreride.scenarios.validation.check import Check, relative


def good() -> Check:
    return Check("mass", "a balance", 0.001, 0.01)


def bad() -> Check:
    return Check("length", "a ruler", 0.02, 0.01, "m")


def broken() -> Check:
    raise ZeroDivisionError("no scale")


def run(monkeypatch, tmp_path, *checks):
    monkeypatch.setattr(areas, "AREAS", {"House": checks})
    out, numbers = tmp_path / "table.md", tmp_path / "rows.json"
    code = main(["validation", "--out", str(out), "--json", str(numbers)])
    return code, out.read_text(), json.loads(numbers.read_text())


def test_all_inside_their_bounds(monkeypatch, tmp_path):
    code, table, numbers = run(monkeypatch, tmp_path, good)
    assert code == 0
    assert "| mass | a balance | 0.1 % | 1 % | pass |" in table
    assert numbers["passed"]
    assert numbers["checks"][0]["deviation"] == 0.001


def test_one_outside_fails_the_command_and_hides_no_other(monkeypatch, tmp_path):
    code, table, numbers = run(monkeypatch, tmp_path, bad, broken, good)
    assert code == 1
    assert "| length | a ruler | 0.02 m | 0.01 m | **FAIL** |" in table
    assert "ZeroDivisionError: no scale" in table
    assert [row["passed"] for row in numbers["checks"]] == [False, False, True]


def test_a_deviation_that_is_not_a_number_fails():
    assert not Check("x", "y", math.nan, 1.0).passed
    assert relative([1.0, 1.1], [1.0, 1.0]) == pytest.approx(0.1)


@pytest.mark.slow
def test_everything_passes(tmp_path):
    assert main(["validation", "--out", str(tmp_path / "validation.md")]) == 0


@pytest.mark.parametrize("check", published.CHECKS)
def test_published_cases_are_met_by_whole_drives(check):
    result = check()
    assert result.passed, f"{result.name}: {result.deviation:.2g} of {result.bound:.2g}"
