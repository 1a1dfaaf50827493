"""Tests of the example car."""

import json
from pathlib import Path

from foreride.scenarios.cli import main
from foreride.vehicle.load import load_vehicle

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"


def test_the_own_car_drives_and_gains_from_preview(tmp_path: Path) -> None:
    numbers = tmp_path / "numbers.json"
    arguments = ["compare", str(EXAMPLES / "own_vehicle_drive.yaml"), "--controllers", "passive,mpc_preview"]
    assert (
        main([*arguments, "--observer", "truth", "--json", str(numbers), "--out", str(tmp_path / "runs")])
        == 0
    )
    passive, preview = json.loads(numbers.read_text())["rows"]
    assert preview["metrics"]["objective"] < 0.8 * passive["metrics"]["objective"]
    (manifest,) = (tmp_path / "runs").glob("*passive*/manifest.json")
    driven = json.loads(manifest.read_text())["definition"]["vehicle"]["parameters"]
    assert driven["body_mass_kg"] == load_vehicle(EXAMPLES / "own_vehicle.yaml").body_mass_kg == 1050
