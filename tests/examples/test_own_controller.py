"""Tests of the example controller."""

import json
from pathlib import Path

from foreride.scenarios.cli import main

EXAMPLE = Path(__file__).resolve().parents[2] / "examples" / "own_controller.py"


def test_the_example_beats_the_passive_car_on_a_hump(tmp_path: Path) -> None:
    numbers = tmp_path / "numbers.json"
    controllers = f"passive,{EXAMPLE}:Anticipating"
    arguments = ["compare", "hump_flat_30", "--vehicle", "quarter", "--controllers", controllers]
    assert main([*arguments, "--perception", "oracle", "--json", str(numbers)]) == 0
    passive, own = json.loads(numbers.read_text())["rows"]
    assert own["metrics"]["objective"] < 0.8 * passive["metrics"]["objective"]
