"""Tests of the command line under any input: one printable line and a meaningful exit code."""

import json
import os
import subprocess
import sys
from importlib.metadata import version
from pathlib import Path

import pytest

from foreride.files.errors import InputError
from foreride.scenarios import cli
from foreride.scenarios.commands import COMMANDS
from foreride.scenarios.commands.inspect.listing import TOPICS

NEEDED = {
    **{
        name: ["scenario"]
        for name in ("run", "compare", "sweep", "bound", "render", "report", "road", "log", "replay")
    },
    "calibrate": ["photo.jpg", "--squares", "9x6", "--square_m", "0.03"],
    "detector": ["eval"],
    "fmu": ["export", "vehicle", "scenario", "--out", "car.fmu"],
    "table": ["budget"],
    "list": ["scenarios"],
}
"""Arguments without which a command does not parse."""


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
            "foreride: run: argument --jobs: invalid int value: 'two'; `foreride run --help` lists",
        ),
        (["run"], "required: scenario"),
        (["fly\nhigh"], r"COMMAND must be one of demo, run, compare,"),
        (["comapre"], "got 'comapre'; did you mean compare?"),
        (["--fly"], "required: COMMAND"),
        ([], "required: COMMAND"),
        (["detector", "eval", "--data"], "--data: expected one argument"),
        (["run", "bump_8x40_30", "x"], "foreride: run: takes no 'x'; `foreride run --help` lists"),
        (
            ["detector", "eval", "--data", "d", "x"],
            "foreride: detector eval: takes no 'x'; `foreride detector",
        ),
        (["run", "bump_8x40_30", "--seeds", "4-1"], "--seeds must be whole numbers in 0 ... 4294967295, or"),
        (["run", "bump_8x40_30", "--seeds", "0-9999999"], "--seeds must be at most 100000 numbers"),
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


@pytest.mark.parametrize(
    "use",
    [
        pytest.param("", id="import"),
        pytest.param("foreride.scenarios.cli.main(['--help'])", id="help"),
        pytest.param("foreride.scenarios.cli.main(['comapre'])", id="unknown command"),
    ],
)
def test_a_library_is_imported_by_the_command_that_uses_it(use: str) -> None:
    code = (
        "import sys, foreride.scenarios.cli\n"
        f"try: {use or 'pass'}\nexcept SystemExit: pass\nprint('modules:', *sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    loaded = done.stdout.rpartition("modules:")[2].split()
    assert "foreride.files.errors" in loaded
    assert not {"numpy", "casadi", "mujoco", "numba", "yaml", "rich", "matplotlib", "scipy"} & set(loaded)


def test_each_command_is_known_by_the_table_alone(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit, match="0"):
        cli.main(["--help"])
    listing = " ".join(capsys.readouterr().out.split())
    full = cli.parser()
    (commands,) = (action for action in full._actions if action.dest == "command")
    assert set(COMMANDS) == set(commands.choices or ())
    for name, (_, summary) in COMMANDS.items():
        assert f"{name} {summary}" in listing
        assert full.parse_args([name, *NEEDED.get(name, [])]).command == name


@pytest.mark.parametrize("name", ["run", "detector"])
def test_help_of_one_command_equals_that_of_the_whole_parser(
    capsys: pytest.CaptureFixture[str], name: str
) -> None:
    texts = []
    for parse in (cli.main, cli.parser().parse_args):
        with pytest.raises(SystemExit, match="0"):
            parse([name, "--help"])
        texts.append(capsys.readouterr().out)
    assert texts[0] == texts[1]
    assert f"usage: foreride {name}" in texts[0]


def test_the_version_is_told(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit, match="0"):
        cli.main(["--version"])
    assert capsys.readouterr().out == f"foreride {version('foreride')}\n"


@pytest.mark.parametrize("name", COMMANDS)
def test_help_breaks_no_word(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """However narrow the terminal is, each line of the help holds whole words of the wide one."""
    words = []
    for columns in ("1000", "40"):
        monkeypatch.setenv("COLUMNS", columns)
        (commands,) = (action for action in cli.parser(name)._actions if action.dest == "command")
        helped = commands.choices[name].format_help()  # type: ignore[index]
        words.append(set(helped.partition("\n\n")[2].split()))
    assert words[0] == words[1]


@pytest.mark.parametrize("topic", TOPICS)
def test_names_are_listed(topic: str, capfd: pytest.CaptureFixture[str]) -> None:
    """With their meaning, on a line each; as JSON on standard output, then with the lines on stderr."""
    assert cli.main(["list", topic]) == 0
    lines = [line.split(maxsplit=1) for line in capfd.readouterr().out.splitlines()]
    assert all(len(line) == 2 for line in lines), lines
    assert cli.main(["list", topic, "--json", "-"]) == 0
    out, err = capfd.readouterr()
    parts = json.loads(out)[topic]
    assert [part["name"].split()[0] for part in parts] == [first for first, _ in lines]
    assert len(err.splitlines()) == len(lines)


@pytest.mark.parametrize("encoding", ["ascii", "utf-8", "latin-1"])
def test_a_name_that_no_terminal_can_show_is_printed_all_the_same(encoding: str) -> None:
    command = [sys.executable, "-m", "foreride.scenarios.cli", "run", os.fsdecode(b"stra\xc3\x9fe-\xff.yaml")]
    environment = os.environ | {"PYTHONIOENCODING": encoding}
    done = subprocess.run(command, capture_output=True, env=environment, check=False)
    assert done.returncode == cli.BAD_INPUT
    (line,) = done.stderr.splitlines()
    assert b"no such scenario file" in line


@pytest.mark.parametrize("arguments", [["--help"], ["road", "bump_8x40_30"]])
def test_a_reader_that_ends_early_ends_the_command_quietly(arguments: list[str]) -> None:
    reader, writer = os.pipe()
    os.close(reader)
    command = [sys.executable, "-m", "foreride.scenarios.cli", *arguments]
    ended = subprocess.run(command, stdout=writer, stderr=subprocess.PIPE, text=True, timeout=300)
    os.close(writer)
    assert [line for line in ended.stderr.splitlines() if "onnxruntime" not in line] == []
    assert ended.returncode in (0, cli.BROKEN_PIPE)  # argparse ignores errors when it prints its help


@pytest.mark.parametrize(
    "command",
    ["fmu export loop bump_8x40_30 --out a.fmu", "table grades", "table proving_ground", "demo",
     "tune bump_8x40_30"],
)  # fmt: skip
def test_every_seed_is_checked(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main([*command.split(), "--seed", "-1"]) == 2
    assert capsys.readouterr().err == "foreride: --seed must lie in 0 ... 4294967295, got -1\n"


@pytest.mark.parametrize(
    ("command", "told"),
    [
        (
            "fmu export vehicle bump_8x40_30 --code c --controller skyhook",
            "--controller is for controller",
        ),
        ("fmu export vehicle bump_8x40_30 --preview-step-m 0.1", "--preview-step-m is for controller"),
        ("fmu export controller bump_8x40_30 --perception boxes", "--perception is for loop"),
        ("replay {} --scenario bump_8x40_30 --images here", "--images must be left out for the folder"),
        ("replay {} --scenario bump_8x40_30 --signal a=b", "--signal must be left out for the folder"),
        ("replay {}/log.csv --scenario bump_8x40_30 --stereo", "--stereo must be left out for"),
        ("replay {}/none", "none: must be a file .mcap, .mf4, .mdf, .dat, .csv or a folder, got nothing"),
        ("log {}/none --out a.mcap", "none: no such folder (run)"),
        ("log {}/log.csv --out a.mcap", "log.csv: must be a folder (run)"),
    ],
)
def test_an_option_or_a_file_that_does_not_apply_is_refused(
    command: str, told: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "log.csv").write_text("time_s,speed_m_s\n0,1\n")
    words = command.format(tmp_path).split()
    words += ["--out", str(tmp_path / "a.fmu")] if words[0] == "fmu" else []
    assert cli.main(words) == 2
    assert told in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["log.csv"]
