"""Tests of the example road from a CSV file: its facts and a drive."""

import json
from pathlib import Path

import numpy as np
import pytest

from foreride.road.io.surface_file import read_surface
from foreride.scenarios.cli import main
from foreride.scenarios.definition.loading import load

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
SCENARIO = EXAMPLES / "own_road.yaml"


def test_the_road_of_the_file_lies_under_the_wheels() -> None:
    road, rows = load(str(SCENARIO)).road, np.loadtxt(EXAMPLES / "own_road.csv", delimiter=",", skiprows=3)
    assert road.length_m == 90
    beyond_fade = rows[rows[:, 0] >= 5]
    away = np.abs(beyond_fade[:, 0] - 75.4) > 0.5  # from the manhole cover
    for column, y in ((1, 0.75), (2, -0.75)):
        felt = road.height(beyond_fade[away, 0], y)
        np.testing.assert_allclose(felt, beyond_fade[away, column], atol=1e-12)
    assert road.height(75.35, 0.75) == pytest.approx(
        read_surface(EXAMPLES / "own_road.csv").height(75.35, 0.75) - 0.025
    )


def test_facts_and_drive(tmp_path: Path) -> None:
    facts, numbers = tmp_path / "facts.json", tmp_path / "numbers.json"
    assert main(["road", str(SCENARIO), "--json", str(facts)]) == 0
    told = json.loads(facts.read_text())
    assert told["length_m"] == 90
    assert [feature["kind"] for feature in told["features"]] == ["manhole_cover"]
    assert [track["y_m"] for track in told["tracks"]] == [0.75, -0.75]
    assert all(4 < track["iri_m_km"] < 10 for track in told["tracks"])
    arguments = ["compare", str(SCENARIO), "--controllers", "passive", "--perception", "none"]
    assert main([*arguments, "--json", str(numbers)]) == 0
    (row,) = json.loads(numbers.read_text())["rows"]
    assert 0.5 < row["metrics"]["wk_rms"] < 5


def test_a_profile_file_alone_tells_its_facts(tmp_path: Path) -> None:
    facts = tmp_path / "facts.json"
    assert main(["road", str(EXAMPLES / "own_road.csv"), "--json", str(facts)]) == 0
    assert json.loads(facts.read_text())["features"] == []


def test_a_bad_profile_is_told_in_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "bad.csv").write_text("x_m,z_m\n0,0\n1,?\n")
    assert main(["road", str(tmp_path / "bad.csv")]) == 2
    message = capsys.readouterr().err
    assert message.count("\n") == 1
    assert "line 3: z_m must be a finite number, got '?'" in message
