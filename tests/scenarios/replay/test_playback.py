"""Replays of one drive from MCAP, ASAM MDF and CSV: they find what the drive itself has found."""

import csv
import json
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from foreride.scenarios.cli import main
from foreride.scenarios.logs.logged_run import read_logged
from foreride.scenarios.logs.mcap_writing import write_mcap
from foreride.scenarios.logs.mdf_writing import write_mdf
from foreride.scenarios.runs.read import read


@pytest.fixture(scope="module")
def logs(run_folder: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("recordings")
    logged = read_logged(run_folder)
    write_mcap(logged, folder / "run.mcap")
    write_mdf(logged, folder / "run.mf4")
    return folder


@pytest.fixture(scope="module")
def of_mcap(logs: Path) -> dict[str, Any]:
    return replayed(logs / "run.mcap", logs / "of_mcap")


def replayed(log: Path, out: Path, *options: str) -> dict[str, Any]:
    assert main(["replay", str(log), "--out", str(out), *options]) == 0
    return json.loads((out / "summary.json").read_text())


def test_the_hump_of_the_drive_is_found_where_it_is(run_folder: Path, of_mcap: dict[str, Any]) -> None:
    run = read(run_folder)
    hump = run.case.scenario.road.features[0]
    assert of_mcap["images"] == len(run.looks)
    (track,) = of_mcap["tracks"]
    assert track["class"] == "speed_bump"
    assert track["x_m"] == pytest.approx(hump.start_m, abs=0.15)
    assert track["height_m"] == pytest.approx(hump.height_m, abs=0.02)
    assert of_mcap["distance_m"] == pytest.approx(run.signals["x_m"][-1] - run.signals["x_m"][0], abs=0.05)


def test_the_folder_holds_tables_preview_and_figure(logs: Path, of_mcap: dict[str, Any]) -> None:
    folder = logs / "of_mcap"
    names = {path.name for path in folder.iterdir()}
    assert names >= {"summary.json", "events.jsonl", "boxes.jsonl", "previews.parquet", "replay.png"}
    events = [json.loads(line) for line in (folder / "events.jsonl").read_text().splitlines()]
    assert {"born", "confirmed"} <= {event["event"] for event in events}
    assert len((folder / "boxes.jsonl").read_text().splitlines()) == of_mcap["images"]


def test_mdf_with_a_folder_of_images_gives_the_same_bits(
    run_folder: Path, logs: Path, of_mcap: dict[str, Any]
) -> None:
    of_mdf = replayed(logs / "run.mf4", logs / "of_mdf", "--images", str(run_folder / "frames"))
    assert of_mdf | {"log": ""} == of_mcap | {"log": ""}
    names = ("events.jsonl", "boxes.jsonl", "previews.parquet")
    assert all(
        (logs / "of_mdf" / name).read_bytes() == (logs / "of_mcap" / name).read_bytes() for name in names
    )


def test_a_table_of_other_units_signs_and_names_gives_the_same_tracks(
    run_folder: Path, logs: Path, of_mcap: dict[str, Any]
) -> None:
    signals = read(run_folder).signals
    columns = {
        "time [ms]": 1e3 * signals["time_s"] + 5000.0,
        "Vehicle speed [km/h]": 3.6 * signals["speed_m_s"],
    }
    columns["gyro y [deg/s]"] = -np.degrees(signals["pitch_rate"])
    for wheel in range(2):
        columns[f"body_acc_{wheel} [g]"] = signals[f"body_acc_{wheel}"] / 9.80665
        columns[f"wheel_acc_{wheel}"] = signals[f"wheel_acc_{wheel}"]
        columns[f"rattle_m_{wheel} [mm]"] = 1e3 * signals[f"rattle_m_{wheel}"]
    with (logs / "drive.csv").open("w", newline="") as stream:
        csv.writer(stream, delimiter=";").writerows([list(columns), *zip(*columns.values(), strict=True)])
    images = logs / "pictures"
    shutil.copytree(run_folder / "frames", images)
    rows = [(5.0 + int(path.stem) / 1000, path.name) for path in sorted(images.iterdir())]
    (images / "images.csv").write_text("time_s,file\n" + "".join(f"{t},{name}\n" for t, name in rows))
    (logs / "car.yaml").write_text(
        "title: The car of the recording\nspeed_kmh: 30\nvehicle: {model: half}\nroad: {length_m: 100}\n"
    )
    told = replayed(
        logs / "drive.csv", logs / "of_csv", "--images", str(images), "--scenario", str(logs / "car.yaml"),
        "--signal", "speed_m_s=Vehicle speed", "--signal", "pitch_rate=-gyro y",
    )  # fmt: skip
    assert told["start_s"] == pytest.approx(5.0)
    (track,), (expected,) = told["tracks"], of_mcap["tracks"]
    for name in ("x_m", "length_m", "height_m", "existence"):
        assert track[name] == pytest.approx(expected[name], abs=1e-3)


def test_a_recording_of_speed_and_images_alone_is_replayed_with_constants(
    logs: Path, of_mcap: dict[str, Any]
) -> None:
    names = [
        "pitch_rate",
        *(f"{kind}_{wheel}" for kind in ("body_acc", "wheel_acc", "rattle_m") for wheel in (0, 1)),
    ]
    constants = [word for name in names for word in ("--signal", f"{name}=0")]
    told = replayed(logs / "run.mcap", logs / "of_speed", *constants)
    assert [track["class"] for track in told["tracks"]] == ["speed_bump"]
    assert told["tracks"][0]["x_m"] == pytest.approx(of_mcap["tracks"][0]["x_m"], abs=0.5)
