"""Tests of the command line under any input: one printable line and a meaningful exit code."""

import os
import subprocess
import sys

import pytest

from foreride.files.errors import InputError
from foreride.scenarios import cli


def outcome(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str]:
    """Exit code and the one line on stderr."""
    try:
        status = cli.main(list(arguments))
    except SystemExit as error:
        status = int(str(error.code))
    (line,) = capsys.readouterr().err.splitlines()
    assert line.isprintable()
    assert len(line) < 600
    return status, line


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["run", "nul\0byte"], "must not hold NUL characters"),
        (["run", "half\ud800pair"], "must be text"),
        (["run", "not-utf8-\udcff.yaml"], r"not-utf8-\udcff.yaml: no such scenario file"),
        (["run", "x" * 100_000 + ".yaml"], "xxx"),
        (["run", "bump_8x40_30", "--controllers", ","], "--controllers: must name at least one, got ','"),
        (["run", "bump_8x40_30", "--perception", ""], "--perception: must name at least one, got ''"),
        (["run", "bump_8x40_30", "--seeds", " , "], "--seeds: must name at least one"),
        (["run", "bump_8x40_30", "--jobs", "9" * 5000], "--jobs: invalid int value"),
        (
            ["run", "bump_8x40_30", "--jobs", "two"],
            "invalid int value: 'two'; --help lists the options",
        ),
        (["run"], "required: scenario"),
        (["fly\nhigh"], "invalid choice"),
        ([], "required: COMMAND"),
        (["detector", "eval", "--data"], "--data: expected one argument"),
    ],
)
def test_bad_arguments_are_told_in_one_line_with_exit_code_2(
    capsys: pytest.CaptureFixture[str], arguments: list[str], told: str
) -> None:
    status, line = outcome(capsys, *arguments)
    assert status == cli.BAD_INPUT
    assert told in line


@pytest.mark.parametrize(
    ("error", "status", "told"),
    [
        (InputError("a.yaml: wrong"), 2, "foreride: a.yaml: wrong"),
        (OSError(28, "No space left on device", "a\nb"), 2, "foreride: a b: No space left on device"),
        (MemoryError(), 2, "foreride: needs more memory than there is"),
        (KeyboardInterrupt(), 130, "foreride: interrupted"),
        (KeyError("x" * 10_000), 70, "foreride: internal error, KeyError: 'xxx"),
        (RecursionError("too deep\n"), 70, "FORERIDE_TRACEBACK=1 shows the traceback"),
    ],
)
@pytest.mark.parametrize("stage", ["parser", "_execute"])
def test_each_kind_of_failure_has_its_exit_code(
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    stage: str,
    error: BaseException,
    status: int,
    told: str,
) -> None:
    def fail(*arguments: object) -> None:
        raise error

    monkeypatch.delenv(cli.TRACEBACK, raising=False)
    monkeypatch.setattr(cli, stage, fail)
    found, line = outcome(capsys, "run", "bump_8x40_30")
    assert found == status
    assert told in line


def test_the_traceback_of_an_internal_error_is_there_for_the_asking(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(argv: object) -> int:
        raise KeyError("x")

    monkeypatch.setattr(cli, "_execute", fail)
    monkeypatch.setenv(cli.TRACEBACK, "1")
    with pytest.raises(KeyError):
        cli.main(["run"])


def test_nothing_slow_is_imported_before_an_interrupt_is_caught() -> None:
    code = "import sys, foreride.scenarios.cli; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert not {"numpy", "casadi", "mujoco", "numba", "yaml", "rich"} & set(done.stdout.split())


@pytest.mark.parametrize("encoding", ["ascii", "utf-8", "latin-1"])
def test_a_name_that_no_terminal_can_show_is_printed_all_the_same(encoding: str) -> None:
    command = [sys.executable, "-m", "foreride.scenarios.cli", "run", os.fsdecode(b"stra\xc3\x9fe-\xff.yaml")]
    environment = os.environ | {"PYTHONIOENCODING": encoding}
    done = subprocess.run(command, capture_output=True, env=environment, check=False)
    assert done.returncode == cli.BAD_INPUT
    (line,) = done.stderr.splitlines()
    assert b"no such scenario file" in line
