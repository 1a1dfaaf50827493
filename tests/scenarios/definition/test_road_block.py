from pathlib import Path

import pytest

from foreride.files.errors import InputError
from foreride.road.tyre.contact_models import RigidWheel, TandemCam
from foreride.scenarios.definition.loading import load

HEAD = "title: t\nspeed_kmh: 30\nvehicle: {model: half}\n"


def scenario(folder: Path, road: str, more: str = "") -> Path:
    path = folder / "mine.yaml"
    path.write_text(f"{HEAD}road: {road}\n{more}")
    return path


def profile(folder: Path, name: str = "drive.csv") -> Path:
    path = folder / name
    path.write_text("x_m,left_m,right_m\n" + "".join(f"{x},0.0,{0.02 * (x == 20)}\n" for x in range(41)))
    return path


def test_file_is_found_beside_the_scenario_and_gives_the_length(tmp_path):
    profile(tmp_path)
    road = load(str(scenario(tmp_path, "{file: drive.csv}"))).road
    assert road.length_m == 40
    assert road.height(20.0, -0.75) == pytest.approx(0.02)
    assert road.height(20.0, 0.75) == 0
    shorter = load(str(scenario(tmp_path, "{file: drive.csv, length_m: 30, roughness: {iso_class: A}}"))).road
    assert (shorter.length_m, shorter.roughness.iso_class) == (30, "A")


def test_content_of_the_file_is_part_of_the_recorded_scenario(tmp_path):
    profile(tmp_path)
    recorded = load(str(scenario(tmp_path, "{file: drive.csv}"))).mapping["road"]
    assert len(recorded["file_sha256"]) == 64


def test_roughness_and_chains_take_the_track_of_the_car(tmp_path):
    chain = "chains: [{feature: {kind: manhole_cover, start_m: 10}, tracks: [left]}]"
    text = f"{{length_m: 60, roughness: {{iso_class: B}}, {chain}}}"
    path = scenario(tmp_path, text)
    road = load(str(path), ["vehicle.parameters.track_m=1.7"]).road
    assert road.roughness.track_m == 1.7
    assert road.features[0].y_m == pytest.approx(0.85)


def test_way_over_short_obstacles_is_a_field(tmp_path):
    path = str(scenario(tmp_path, "{length_m: 60}"))
    assert load(path).enveloping == RigidWheel()
    assert load(path, ["enveloping.kind=tandem_cam", "enveloping.order=1.8"]).enveloping == TandemCam(
        order=1.8
    )


@pytest.mark.parametrize(
    ("road", "message"),
    [
        ("{file: none.csv}", r"mine\.yaml: road\.file: none\.csv: cannot be read"),
        ("{file: drive.csv, length_m: 99}", r"road\.length_m must be <= 40 m \(end of"),
        ("{file: 3}", r"road"),
        ("{length_m: 50, chains: 3}", r"road\.chains must be a list, got 3"),
        ("{length_m: 50, chains: [{count: 2}]}", r"road\.chains\[0\]\.feature is missing"),
        ("{length_m: 50, roughness: rough}", r"road\.roughness must be a mapping"),
        ("flat", r"road must be a mapping"),
    ],
)
def test_bad_roads_are_told(tmp_path, road, message):
    profile(tmp_path)
    with pytest.raises(InputError, match=message):
        load(str(scenario(tmp_path, road)))
