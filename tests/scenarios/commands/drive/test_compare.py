"""Tests of `foreride compare`: equal numbers in every format, for any number of worker processes."""

import json
import shutil
import subprocess
from pathlib import Path

import pyarrow.parquet as pq
import pytest

from foreride.scenarios.cli import main

SHORT = """
title: A short drive
speed_kmh: 40
road:
  length_m: 14
  features:
    - {kind: half_sine_bump, start_m: 6, height_m: 0.05, length_m: 0.5}
vehicle: {model: quarter}
"""
NO_WEIGHTS = ["--perception", "camera", "--set", "detection.weights=no.onnx"]


@pytest.fixture
def short(tmp_path: Path) -> str:
    path = tmp_path / "short.yaml"
    path.write_text(SHORT)
    return str(path)


def test_every_form_holds_the_same_numbers(short: str, tmp_path: Path) -> None:
    files = {form: tmp_path / f"table.{form}" for form in ("json", "parquet", "markdown", "latex")}
    arguments = ["compare", short, "--controllers", "passive,skyhook", "--seeds", "0,1,2"]
    assert (
        main([*arguments, *(part for form, path in files.items() for part in (f"--{form}", str(path)))]) == 0
    )
    document = json.loads(files["json"].read_text())
    values = [row["metrics"]["wk_rms"] for row in document["rows"]]
    assert pq.read_table(files["parquet"])["wk_rms"].to_pylist() == values
    skyhook = next(one for one in document["summary"] if one["controller"] == "skyhook")
    assert skyhook["metrics"]["wk_rms"]["mean"] == pytest.approx(sum(values[1::2]) / 3)
    shown = f"{skyhook['ratio']['objective']['mean']:.3f}"
    assert f"| {shown}" in files["markdown"].read_text()
    assert f"& {shown}" in files["latex"].read_text()


def test_two_workers_give_the_same_rows_as_one(short: str, tmp_path: Path) -> None:
    rows = []
    for jobs in ("1", "2"):
        path = tmp_path / f"{jobs}.json"
        arguments = ["compare", short, "--controllers", "passive,mpc_preview", "--seeds", "3,4"]
        assert main([*arguments, "--jobs", jobs, "--json", str(path)]) == 0
        rows.append([row | {"timing": None} for row in json.loads(path.read_text())["rows"]])
    assert rows[0] == rows[1]


def test_the_latex_table_compiles_where_latex_is_installed(short: str, tmp_path: Path) -> None:
    path = tmp_path / "table.tex"
    assert main(["compare", short, "--controllers", "passive,skyhook", "--latex", str(path)]) == 0
    text = path.read_text()
    rows = [line for line in text.splitlines() if line.endswith(r"\\")]
    assert len({line.count("&") for line in rows}) == 1
    assert r"\begin{tabular}{lll" in text
    if latex := shutil.which("pdflatex"):
        page = r"\documentclass{article}\usepackage{booktabs}\begin{document}" + text + r"\end{document}"
        (tmp_path / "page.tex").write_text(page)
        subprocess.run([latex, "-halt-on-error", "page.tex"], cwd=tmp_path, check=True, capture_output=True)


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["--baseline", "mpc_magic"], "mpc_magic"),
        (["--baseline", "passive@camera"], "passive@none"),
        (["--jobs", "-2"], "-2"),
        (["--controllers", "passive,nowhere.py:Mine"], "nowhere.py"),
        (["--controllers", "passive,mpc_preview", *NO_WEIGHTS], "no.onnx"),
    ],
)
def test_bad_options_are_told_before_anything_runs(
    short: str, tmp_path: Path, capsys: pytest.CaptureFixture[str], arguments: list[str], told: str
) -> None:
    out = tmp_path / "out"
    assert main(["compare", short, "--controllers", "passive,skyhook", "--out", str(out), *arguments]) == 2
    lines = capsys.readouterr().err.strip().splitlines()
    assert len(lines) == 1
    assert told in lines[0]
    assert not out.exists()
