"""Tests of the command line: results, exit codes and one-line messages."""

import json
from pathlib import Path

import pyarrow.parquet as pq
import pytest

from foreride.scenarios.cli import main
from foreride.scenarios.commands.options import settings_overrides
from foreride.scenarios.definition.loading import load
from foreride.scenarios.runs.read import read

SHORT = """
title: A short drive
speed_kmh: 40
road:
  length_m: 16
  features:
    - {kind: half_sine_bump, start_m: 8, height_m: 0.05, length_m: 0.5}
vehicle: {model: quarter}
"""


@pytest.fixture
def short(tmp_path: Path) -> str:
    path = tmp_path / "short.yaml"
    path.write_text(SHORT)
    return str(path)


def test_run_writes_the_run_folder(short: str, tmp_path: Path) -> None:
    out = tmp_path / "out"
    assert main(["run", short, "--perception", "oracle", "--out", str(out)]) == 0
    folder = out / "short-quarter-mpc_preview-oracle-seed0"
    names = {path.name for path in folder.iterdir()}
    tables = {"signals.parquet", "previews.parquet"}
    assert names == {"foreride.json", "manifest.json", "metrics.json", "events.jsonl"} | tables
    manifest = json.loads((folder / "manifest.json").read_text())
    assert manifest["schema"] == 1
    assert manifest["seed"] == 0
    assert len(manifest["scenario_hash"]) == 64
    assert manifest["definition"]["speed_kmh"] == 40
    signals = pq.read_table(folder / "signals.parquet")
    assert signals.num_rows == int((16 - 2) / (40 / 3.6) * 1000) + 1
    assert {"time_s", "x_m", "seat_acc_0", "tyre_force_0", "damping_0"} <= set(signals.column_names)
    metrics = json.loads((folder / "metrics.json").read_text())
    assert metrics["objective"] == pytest.approx(metrics["wk_rms"] ** 2 + 3 * metrics["tyre_load_rms"] ** 2)


def test_the_same_seed_gives_the_same_bytes_and_another_seed_does_not(short: str, tmp_path: Path) -> None:
    folder = "short-half-mpc_preview-boxes-seed{}"
    texts = []
    for out, seed in (("a", 0), ("b", 0), ("c", 1)):
        arguments = ["run", short, "--vehicle", "half", "--perception", "boxes", "--seeds", str(seed)]
        assert main([*arguments, "--out", str(tmp_path / out)]) == 0
        run = tmp_path / out / folder.format(seed)
        texts.append((run / "metrics.json").read_bytes() + (run / "signals.parquet").read_bytes())
    assert texts[0] == texts[1]
    assert texts[0] != texts[2]


def test_compare_writes_rows(short: str, tmp_path: Path) -> None:
    path = tmp_path / "numbers.json"
    arguments = ["compare", short, "--controllers", "passive,mpc_preview", "--perception", "none,oracle"]
    assert main([*arguments, "--seeds", "0,1", "--json", str(path)]) == 0
    document = json.loads(path.read_text())
    assert document["schema"] == 1
    assert "versions" in document["manifest"]
    cases = [(row["controller"], row["perception"], row["seed"]) for row in document["rows"]]
    one = [("passive", "none"), ("mpc_preview", "none"), ("mpc_preview", "oracle")]
    assert cases == [(*case, seed) for seed in (0, 1) for case in one]
    keys = {"scenario", "vehicle", "controller", "perception", "seed", "metrics", "timing", "solver"}
    assert all(keys | {"perception_stats", "observer_error"} == set(row) for row in document["rows"])


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["--controllers", "skyhok"], "skyhok"),
        (["--perception", "radar"], "radar"),
        (["--seeds", "-1"], "seeds"),
        (["--set", "speed_kmh=0"], "speed_kmh"),
        (["--set", "vehicle.parameters.sprung_mass_kg=-400"], "sprung_mass_kg"),
        (["--vehicle", "tricycle"], "tricycle"),
        (["--controllers", "nowhere.py:Mine"], "nowhere.py"),
        (["--perception", "camera", "--set", "detection.weights=missing.onnx"], "missing.onnx"),
        (["--perception", "oracle,map"], "map"),
        (["--perception", "oracle,map", "--set", "map.file=missing.csv"], "missing.csv"),
        (["--perception", "oracle,boxes", "--set", "memory=missing.yaml"], "missing.yaml"),
    ],
)
def test_bad_input_ends_with_one_line_and_code_2(
    short: str, tmp_path: Path, capsys: pytest.CaptureFixture[str], arguments: list[str], told: str
) -> None:
    out = tmp_path / "out"
    assert main(["run", short, "--out", str(out), *arguments]) == 2
    lines = capsys.readouterr().err.strip().splitlines()
    assert len(lines) == 1
    assert told in lines[0]
    assert not out.exists()


def test_corrupt_weights_are_refused_before_anything_is_written(
    short: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    weights, out = tmp_path / "corrupt.onnx", tmp_path / "out"
    weights.write_bytes(b"not a model")
    arguments = ["run", short, "--perception", "camera", "--set", f"detection.weights={weights}"]
    assert main([*arguments, "--out", str(out)]) == 2
    assert "corrupt.onnx" in capsys.readouterr().err
    assert not out.exists()


def test_settings_from_a_file_arrive_as_they_were_written(short: str, tmp_path: Path) -> None:
    """None stays None, small numbers stay numbers, and omitted fields stay unchanged."""
    given = {"passive": {"damping_ns_m": None}, "mpc": {"road": {"blend_m": 0.3}}, "user": {"gain": 1e-5}}
    file = tmp_path / "mine.yaml"
    file.write_text(json.dumps(given))
    settings = load(
        short, ["control.settings.mpc.road.sigmas_early=2.0", *settings_overrides(file)]
    ).control.settings
    assert settings.passive.damping_ns_m is None
    assert (settings.mpc.road.blend_m, settings.mpc.road.sigmas_early) == (0.3, 2.0)
    assert settings.user == {"gain": 1e-5}


def test_a_manifest_pins_map_and_memory_and_its_hash_does_not_depend_on_where_one_stands(
    short: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    mapped = tmp_path / "mapped.yaml"
    mapped.write_text(SHORT + "map: {file: map.csv}\n")
    found = []
    for place, named, height in ((tmp_path, "mapped.yaml", 0), (tmp_path.parent, str(mapped), 0.01)):
        (tmp_path / "map.csv").write_text(f"x_m,z_m\n0,0\n10,{height}\n20,0\n")
        monkeypatch.chdir(place)
        out = tmp_path / f"out{height}"
        assert main(["run", named, "--perception", "map", "--out", str(out)]) == 0
        (manifest,) = out.glob("*/manifest.json")
        found.append(json.loads(manifest.read_text()))
        assert read(manifest.parent).files_sha256["map_sha256"] == found[-1]["map_sha256"]
    assert found[0]["scenario_hash"] == found[1]["scenario_hash"]
    assert found[0]["map_sha256"] != found[1]["map_sha256"]
    assert found[0]["weights_sha256"] is found[0]["memory_sha256"] is None


def test_an_own_controller_is_driven(short: str, tmp_path: Path) -> None:
    own = tmp_path / "mine.py"
    own.write_text(
        "import numpy as np\n"
        "class Stiff:\n"
        "    def __init__(self, vehicle, timing): self.wheels = vehicle.wheels\n"
        "    def reset(self): pass\n"
        "    def step(self, estimate, preview): return np.full(self.wheels, 4000.0)\n"
    )
    path = tmp_path / "numbers.json"
    assert main(["compare", short, "--controllers", f"passive,{own}:Stiff", "--json", str(path)]) == 0
    passive, stiff = json.loads(path.read_text())["rows"]
    assert stiff["metrics"]["rattle_rms"] < 0.7 * passive["metrics"]["rattle_rms"]
