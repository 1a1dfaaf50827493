"""Tests of the commands' output checks: foreign files are untouched, and errors come before any work."""

import shutil
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from foreride.files.errors import InputError
from foreride.scenarios.cases import Case, cases, distinct
from foreride.scenarios.cli import main
from foreride.scenarios.commands import COMMANDS, options
from foreride.scenarios.definition.loading import load
from foreride.scenarios.runs.read import is_run, read
from foreride.scenarios.runs.write import folder_name, write

SHORT = """
title: A short drive
speed_kmh: 60
road:
  length_m: 8
  features:
    - {kind: half_sine_bump, start_m: 5, height_m: 0.05, length_m: 0.5}
vehicle: {model: quarter}
"""


@pytest.fixture
def short(tmp_path: Path) -> Path:
    path = tmp_path / "short.yaml"
    path.write_text(SHORT)
    return path


@pytest.fixture
def no_work(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: Any, **__: Any) -> None:
        raise AssertionError("work was done")

    for name in ("simulate_each", "progress_bar"):
        monkeypatch.setattr(options, name, refuse)
    for command in ("render", "tune", "sweep"):
        module = import_module(f"foreride.scenarios.commands.{COMMANDS[command][0]}")
        for name in ("atomic_folder", "progress_bar", "cluster"):
            if hasattr(module, name):
                monkeypatch.setattr(module, name, refuse)


STUDY = "scenarios: [short.yaml]\ncontrollers: [passive]\nvary: {speed_kmh: {values: [50, 60]}}\n"


@pytest.mark.parametrize("command", ["render", "run", "compare", "demo", "sweep", "perception"])
@pytest.mark.parametrize("place", [".", "..", "victim", "/", "~"])
def test_a_folder_of_others_is_refused_before_any_work(
    short: Path, command: str, place: str, no_work: None, capsys: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    (short.parent / "study.yaml").write_text(STUDY)
    for folder in ("victim", "here"):
        (short.parent / folder).mkdir()
        (short.parent / folder / "thesis.txt").write_text("mine")
    monkeypatch.chdir(short.parent / "here")
    monkeypatch.setenv("HOME", str(short.parent))
    named = {"demo": [], "sweep": [str(short.parent / "study.yaml")]}.get(command, [str(short)])
    out = {"victim": str(short.parent / "victim"), "~": str(short.parent)}.get(place, place)
    before = sorted(short.parent.rglob("*"))
    assert main([command, *named, "--out", out]) == 2
    (told,) = capsys.readouterr().err.strip().splitlines()
    assert out in told
    assert sorted(short.parent.rglob("*")) == before


def test_a_folder_that_a_command_made_is_replaced(short: Path) -> None:
    out = short.parent / "images"
    for _ in range(2):
        assert main(["render", str(short), "--every", "2", "--out", str(out)]) == 0
    assert (out / "boxes.json").exists()


@pytest.mark.parametrize("option", ["--json", "--parquet", "--markdown", "--latex"])
@pytest.mark.parametrize("place", ["folder", "short.yaml", "short.yaml/inner", "runs/short/metrics.json"])
def test_a_file_that_cannot_be_written_is_told_before_any_work(
    short: Path, option: str, place: str, no_work: None, capsys: Any
) -> None:
    (short.parent / "folder").mkdir()
    (short.parent / "runs" / "short").mkdir(parents=True)
    marker = '{"kind": "run", "version": 1, "sha256": {"metrics.json": "0"}}'
    (short.parent / "runs" / "short" / "foreride.json").write_text(marker)
    assert main(["run", str(short), option, str(short.parent / place)]) == 2
    (told,) = capsys.readouterr().err.strip().splitlines()
    assert place in told


def test_two_outputs_are_two_files(short: Path, no_work: None, capsys: Any) -> None:
    place = str(short.parent / "numbers")
    assert main(["run", str(short), "--json", place, "--parquet", place]) == 2
    assert "two outputs" in capsys.readouterr().err


@pytest.mark.parametrize(
    "name", ["../victim/report", "/tmp/x", "", "a\\nb", ".", "..", "a\\0b", " ", "x" * 200, "C:\\\\x"]
)
def test_a_name_is_no_path(short: Path, name: str, capsys: Any, no_work: None) -> None:
    short.write_text(f'name: "{name}"\n{SHORT}')
    assert main(["run", str(short), "--out", str(short.parent / "out")]) == 2
    (told,) = capsys.readouterr().err.strip().splitlines()
    assert str(short) in told
    assert not (short.parent / "out").exists()


def test_a_car_of_ones_own_gets_a_folder_that_can_be_reported(short: Path) -> None:
    source = Path(__file__).parents[2] / "examples" / "own_vehicle.yaml"
    cars = short.parent / "cars"
    cars.mkdir()
    shutil.copy(source, cars / "Mine.yaml")
    out = short.parent / "out"
    words = ["run", str(short), "--vehicle", str(cars / "Mine.yaml"), "--controllers", "passive"]
    assert main([*words, "--out", str(out)]) == 0
    (folder,) = (path for path in out.iterdir() if path.is_dir())
    assert is_run(folder)
    assert main(["report", str(out), "--out", str(short.parent / "report.html")]) == 0


def test_what_is_named_twice_runs_once(short: Path) -> None:
    out = short.parent / "out"
    words = ["run", str(short), "--controllers", "passive,passive", "--seeds", "0,0,00"]
    assert main([*words, "--out", str(out)]) == 0
    assert len([path for path in out.iterdir() if path.is_dir()]) == 1


def test_two_scenarios_of_one_name_are_refused(short: Path, capsys: Any, no_work: None) -> None:
    other = short.parent / "deep" / "short.yaml"
    other.parent.mkdir()
    other.write_text(SHORT.replace("60", "50"))
    out = ["--controllers", "passive", "--out", str(short.parent / "out")]
    assert main(["compare", str(short), str(other), *out]) == 2
    assert "differ in their `name`" in capsys.readouterr().err
    study = short.parent / "study.yaml"
    study.write_text("scenarios: [short.yaml, deep/short.yaml]\ncontrollers: [passive]\n")
    assert main(["sweep", str(study), "--out", str(short.parent / "sweep")]) == 2
    assert "differ in their files' names" in capsys.readouterr().err


def test_different_cases_have_different_folders(short: Path) -> None:
    scenario = load(str(short))
    controllers = ["passive", "a/b.py:C", "a_b.py:C", "a/b.py:c", "A/b.py:C"]
    wanted = distinct(cases([scenario], controllers, ["oracle", "camera"], [0, 1]))
    names = {folder_name(case).lower() for case in wanted}
    assert len(names) == len(wanted)
    assert folder_name(Case(scenario, "passive", "none", 0)) == "short-quarter-passive-none-seed0"
    with pytest.raises(InputError, match="differ"):
        distinct(
            [
                Case(scenario, "passive", "none", 0),
                Case(load(str(short), ["start_m=1"]), "passive", "none", 0),
            ]
        )


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("runs")
    (folder / "short.yaml").write_text(SHORT)
    words = ["compare", str(folder / "short.yaml"), "--controllers", "passive,skyhook,fixed"]
    assert main([*words, "--out", str(folder / "out")]) == 0
    return folder / "out"


def test_every_flipped_bit_of_the_signals_is_found(runs: Path, tmp_path: Path) -> None:
    folder = tmp_path / "run"
    shutil.copytree(runs / "short-quarter-passive-none-seed0", folder)
    whole = (folder / "signals.parquet").read_bytes()
    for bit in np.random.default_rng(0).integers(0, 8 * len(whole), 300):
        flipped = bytearray(whole)
        flipped[bit // 8] ^= 1 << bit % 8
        (folder / "signals.parquet").write_bytes(flipped)
        with pytest.raises(InputError, match="is damaged"):
            read(folder)


def test_a_damaged_run_and_scratch_are_left_out_and_said(runs: Path, tmp_path: Path, capsys: Any) -> None:
    out, page = tmp_path / "out", tmp_path / "report.html"
    shutil.copytree(runs, out)
    damaged = out / "short-quarter-skyhook-none-seed0"
    content = bytearray((damaged / "signals.parquet").read_bytes())
    content[len(content) // 2] ^= 1
    (damaged / "signals.parquet").write_bytes(content)
    scratch = out / ".short-quarter-fixed-none-seed0.0123abcd.foreride-part"
    shutil.copytree(out / "short-quarter-fixed-none-seed0", scratch)
    capsys.readouterr()
    assert main(["report", str(out), "--out", str(page)]) == 0
    (told,) = capsys.readouterr().err.strip().splitlines()
    assert "partial" in told
    assert damaged.name in told
    text = page.read_text()
    assert "Partial result." in text
    assert damaged.name in text
    assert scratch.name not in text
    assert main(["report", str(scratch), "--out", str(page)]) == 2


def test_a_run_without_checksums_is_refused_with_a_way_on(runs: Path, tmp_path: Path) -> None:
    folder = tmp_path / "old"
    shutil.copytree(runs / "short-quarter-passive-none-seed0", folder)
    (folder / "foreride.json").unlink()
    with pytest.raises(InputError, match="create it again"):
        read(folder)
    run = read(runs / "short-quarter-passive-none-seed0")
    with pytest.raises(InputError, match="choose a new one"):
        write(run, folder)
