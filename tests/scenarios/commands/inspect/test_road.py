"""Tests of `foreride road` on road files: own stations, whole length, segments, notes, options."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pyopencrg
import pytest

from foreride.road.io.surface_file import read_surface
from foreride.road.roughness.iri import iri
from foreride.scenarios.cli import main

X = np.round(0.1 * np.arange(2301), 4)
Z = np.round(0.005 * np.sin(2 * np.pi * X / 2) + np.where(X > 100, 0.004 * np.sin(2 * np.pi * X / 15), 0), 6)


def csv(path: Path, x: np.ndarray, *columns: np.ndarray, header: str = "x_m,z_m") -> Path:
    lines = [header, *(",".join(f"{value:.6f}" for value in row) for row in zip(x, *columns, strict=True))]
    path.write_text("\n".join(lines) + "\n")
    return path


def numbers(folder: Path, *arguments: str) -> dict[str, Any]:
    assert main(["road", *arguments, "--json", str(folder / "road.json")]) == 0
    return json.loads((folder / "road.json").read_text())


def test_a_file_is_summarised_at_its_own_stations_over_its_whole_length(tmp_path: Path) -> None:
    found = numbers(tmp_path, str(csv(tmp_path / "road.csv", X, Z)), "--plot", str(tmp_path / "road.png"))
    track = found["tracks"][0]
    assert (track["start_m"], track["step_m"]) == (0.0, pytest.approx(0.1))
    assert track["iri_m_km"] == pytest.approx(iri(Z, 0.1), rel=1e-6)
    twenty, hundred = found["segments"]["20"][0], found["segments"]["100"][0]
    assert [part["start_m"] for part in twenty] == pytest.approx(np.arange(0, 221, 20))
    assert [(part["start_m"], part["end_m"]) for part in hundred] == [(0, 100), (100, 200)]
    mean = np.mean([part["iri_m_km"] for part in twenty[:5]])
    assert hundred[0]["iri_m_km"] == pytest.approx(mean, rel=1e-9)
    assert hundred[1]["iri_m_km"] > hundred[0]["iri_m_km"]
    assert (tmp_path / "road.png").read_bytes()[:4] == b"\x89PNG"


def test_uneven_stations_are_evened_and_coarse_ones_have_no_index(tmp_path: Path) -> None:
    uneven = np.delete(X, np.arange(50, 2250, 37))
    found = numbers(tmp_path, str(csv(tmp_path / "uneven.csv", uneven, np.interp(uneven, X, Z))))
    assert found["tracks"][0]["iri_m_km"] == pytest.approx(iri(Z, 0.1), rel=0.03)
    coarse = numbers(tmp_path, str(csv(tmp_path / "coarse.csv", X[::50], Z[::50])))
    assert coarse["tracks"][0]["iri_m_km"] is coarse["tracks"][0]["iso_class"] is None
    assert coarse["segments"]["20"] == [[], []]
    assert "stations every 5 m lack the waves" in coarse["notes"][0]


def test_holes_and_narrow_roads_are_noted(tmp_path: Path) -> None:
    v, z = np.array([-0.3, 0.0, 0.3]), np.tile(Z[:401, None], 3)
    z[200:206, 1] = np.nan
    pyopencrg.CrgRoad(z, 0.1, v).save(tmp_path / "narrow.crg", fmt="KDBI")
    found = numbers(tmp_path, str(tmp_path / "narrow.crg"))
    assert [track["y_m"] for track in found["tracks"]] == [0.3, -0.3]
    assert found["notes"][0] == "0.6 m of it had missing heights, filled with the last height across"
    assert found["notes"][1].startswith("covers y = -0.3 ... 0.3 m; the wheels at y = -0.75 and 0.75 m run")


def test_options_of_the_command_read_what_its_errors_propose(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    plain = numbers(tmp_path, str(csv(tmp_path / "plain.csv", X, Z)))
    other = csv(tmp_path / "other.csv", X[::-1] / 20, 1000 * Z, header="t_s,z_m")
    assert main(["road", str(other)]) == 2
    assert "--speed KMH" in capsys.readouterr().err
    asked = numbers(tmp_path, str(other), "--speed", "72", "--unit", "mm", "--reversed")
    assert asked["tracks"][0]["iri_m_km"] == pytest.approx(plain["tracks"][0]["iri_m_km"], rel=1e-6)
    scenario = tmp_path / "other.yaml"
    reading = "{speed_kmh: 72, unit: mm, reversed: true}"
    scenario.write_text(
        f"title: other\nspeed_kmh: 50\nroad: {{file: other.csv, reading: {reading}}}\n"
        "vehicle: {model: quarter}\n"
    )
    driven = numbers(tmp_path, str(scenario))
    assert driven["length_m"] == pytest.approx(230.0)
    assert driven["tracks"][0]["iri_m_km"] == pytest.approx(plain["tracks"][0]["iri_m_km"], rel=0.03)


@pytest.mark.parametrize("ending", ["rdf", "txt.zip"])
def test_a_file_of_no_known_format_is_refused(tmp_path: Path, ending: str, capsys: Any) -> None:
    (tmp_path / f"road.{ending}").write_text("[UNITS]\nLENGTH = 'meter'\n")
    assert main(["road", str(tmp_path / f"road.{ending}")]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "MSC Adams" in line or "a road file must end in .csv" in line


def test_the_command_writes_scenarios_and_converts_files(tmp_path: Path) -> None:
    for name in ("road.crg", "road.csv"):
        path = tmp_path / name
        assert main(["road", "pothole_60x8_40", "--write", str(path), "--step", "0.02"]) == 0
        assert read_surface(path).heights.min() < -0.07
    assert main(["road", str(tmp_path / "road.csv"), "--write", str(tmp_path / "again.crg")]) == 0
    found, expected = read_surface(tmp_path / "again.crg"), read_surface(tmp_path / "road.csv")
    np.testing.assert_allclose(found.heights, expected.heights, atol=1e-6)
    assert main(["road", str(tmp_path / "road.csv"), "--write", str(tmp_path / "road.stl")]) == 2
