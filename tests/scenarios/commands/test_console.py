"""Tests of progress reports where there is no terminal."""

import pytest

from foreride.scenarios.commands import console
from foreride.scenarios.commands.console import suggest, tracked


def test_progress_is_a_line_on_stderr_now_and_then(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    clock = iter(range(0, 1000, 5))
    monkeypatch.setattr(console.time, "monotonic", lambda: float(next(clock)))
    assert list(tracked(range(12), "drives")) == list(range(12))
    out, err = capsys.readouterr()
    assert out == ""
    lines = err.splitlines()
    assert 1 <= len(lines) <= 4
    assert all(line.startswith("foreride: ") and line.endswith(": drives") for line in lines)
    assert " % after " in lines[0]


def test_short_work_reports_nothing(capsys: pytest.CaptureFixture[str]) -> None:
    assert list(tracked(iter("ab"), "letters", 2)) == ["a", "b"]
    assert capsys.readouterr().err == ""


def test_a_suggested_command_can_be_pasted(capsys: pytest.CaptureFixture[str]) -> None:
    suggest("foreride", "report", "my runs/demo")
    assert capsys.readouterr().out == "next: foreride report 'my runs/demo'\n"
