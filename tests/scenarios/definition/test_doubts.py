"""Tests of what is said of unusual cars, roads and results, on stderr and in the manifest."""

import json
from pathlib import Path

import numpy as np
import pytest

from foreride.scenarios.cli import main
from foreride.scenarios.definition.doubts import doubts_of_metrics, doubts_of_scenario
from foreride.scenarios.definition.loading import load, names


def coarse_road(folder: Path) -> Path:
    x = np.arange(0, 61, 5.0)
    lines = ["x_m,z_m", *(f"{a:.1f},{0.02 * np.sin(a):.5f}" for a in x)]
    (folder / "coarse.csv").write_text("\n".join(lines) + "\n")
    scenario = folder / "coarse.yaml"
    scenario.write_text(
        "title: coarse\nspeed_kmh: 60\nroad: {length_m: 12, file: coarse.csv}\n"
        "vehicle: {model: quarter, parameters: {damping_min_ns_m: 50, damping_passive_ns_m: 60}}\n"
    )
    return scenario


def test_doubts_are_said_once_on_stderr_and_kept_in_the_manifest(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path, out = coarse_road(tmp_path), tmp_path / "out"
    assert main(["run", str(path), "--controllers", "passive", "--out", str(out)]) == 0
    said = [line for line in capsys.readouterr().err.splitlines() if "coarse: " in line]
    (manifest,) = out.rglob("manifest.json")
    everything = json.loads(manifest.read_text())["notes"]
    notes = [note for note in everything if note.startswith(("vehicle ", "road "))]
    assert said == [f"foreride: coarse: {note}" for note in notes]
    assert [note.split(":")[0] for note in notes] == ["vehicle quarter", "road coarse.csv"]
    assert "critical damping" in notes[0]
    assert "stations every 5 m" in notes[1]


def test_the_library_raises_no_doubt() -> None:
    assert {name: doubts_of_scenario(load(name)) for name in names() if not name.startswith("published")} == {
        name: () for name in names() if not name.startswith("published")
    }


def test_results_that_nobody_survives_are_doubted() -> None:
    assert doubts_of_metrics({"wk_rms": 3.0}) == ()
    (line,) = doubts_of_metrics({"wk_rms": 44.0})
    assert line.startswith("wk_rms of 44 m/s²")
