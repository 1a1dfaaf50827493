"""Tests of the example map as a perception."""

import json
from pathlib import Path

import pytest

from foreride.scenarios.cli import main

SCENARIO = Path(__file__).resolve().parents[2] / "examples" / "own_map.yaml"


def test_a_map_is_worth_nearly_what_the_true_road_is(tmp_path: Path) -> None:
    numbers = tmp_path / "numbers.json"
    arguments = [
        "compare",
        str(SCENARIO),
        "--vehicle",
        "quarter",
        "--controllers",
        "passive,mpc_reactive,mpc_preview",
    ]
    assert main([*arguments, "--perception", "map,oracle", "--json", str(numbers)]) == 0
    rows = json.loads(numbers.read_text())["rows"]
    j = {(row["controller"], row["perception"]): row["metrics"]["objective"] for row in rows}
    assert j["mpc_preview", "map"] < j["passive", "none"]
    assert j["mpc_preview", "map"] == pytest.approx(j["mpc_preview", "oracle"], rel=0.15)


def test_the_perception_needs_a_map(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["compare", "bump_8x40_30", "--controllers", "mpc_preview", "--perception", "map"]) == 2
    assert "needs the field map" in capsys.readouterr().err
