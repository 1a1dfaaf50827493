"""Tests of the perception report on the command line and of its tables."""

import json
from pathlib import Path

import pytest
from rich.console import Console

from foreride.scenarios.cli import main
from foreride.scenarios.perception_benchmark.table import error_table, use_table

SHORT = """
title: A short drive
speed_kmh: 40
road:
  length_m: 30
  features:
    - {kind: half_sine_bump, start_m: 22, height_m: 0.08, length_m: 0.5}
"""
NOTHING = dict.fromkeys(
    (
        "false_per_km", "first_confirmed_median_m", "bias_m", "sigma_m", "timing_ms_95", "nees", "nees_band",
        "height_error_rms", "right_kind", "estimator_median_ms",
    )
)  # fmt: skip


def shown(table) -> str:
    console = Console(width=160)
    with console.capture() as capture:
        console.print(table)
    return capture.get()


def test_the_command_reports_a_drive_with_a_stereo_pair(tmp_path: Path, capsys) -> None:
    (tmp_path / "short.yaml").write_text(SHORT)
    arguments = ["perception", str(tmp_path / "short.yaml"), "--perception", "boxes", "--seeds", "0,1"]
    arguments += ["--set", "camera.stereo_base_m=0.2", "--json", str(tmp_path / "report.json")]
    assert main(arguments) == 0
    (row,) = json.loads((tmp_path / "report.json").read_text())["rows"]
    assert (row["events"], row["missed"], row["seeds"]) == (2, 0, [0, 1])
    assert row["by_order"][0]["count"] == 2
    assert row["estimator_median_ms"] > 0
    told = capsys.readouterr().out
    assert "short" in told
    assert f"{100 * row['sigma_m']:.1f}" in told


@pytest.mark.parametrize("wrong", ["-1", "-3"])
def test_jobs_are_refused_below_zero(tmp_path: Path, capsys, wrong: str) -> None:
    (tmp_path / "short.yaml").write_text(SHORT)
    assert main(["perception", str(tmp_path / "short.yaml"), f"--jobs={wrong}"]) == 2
    assert "--jobs must lie in 0 ... 1024" in capsys.readouterr().err


def test_what_nothing_tells_is_a_dash() -> None:
    row = {"name": "plain", "events": 0, "missed": 0, "by_distance": [], "by_order": []} | NOTHING
    assert shown(use_table([row])).count(" - ") >= len(NOTHING) - 1
    assert "-" in shown(error_table([row]))


def test_errors_stand_under_their_distance_and_order() -> None:
    near = {"from_m": 2.5, "to_m": 4.0, "bias_m": 0.012, "sigma_m": 0.041}
    far = {"from_m": 15.0, "to_m": 20.0, "bias_m": -0.5, "sigma_m": 1.0}
    orders = [{"order": 1, "timing_ms_95": 13.04}, {"order": 5, "timing_ms_95": 8.01}]
    told = shown(error_table([{"name": "bumps", "by_distance": [near, far], "by_order": orders}]))
    line = next(line for line in told.splitlines() if "bumps" in line)
    assert line.split() == [
        "bumps", "+1.2", "/", "4.1", "-", "-", "-", "-", "-50", "/", "100", "-", "13.0", "8.0",
    ]  # fmt: skip
