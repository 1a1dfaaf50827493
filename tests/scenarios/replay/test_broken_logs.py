"""Recordings that are damaged, foreign or incomplete: one line with file, channel and what is needed."""

import base64
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from asammdf import MDF, Signal
from mcap.writer import Writer

from foreride.scenarios.cli import main

CAR = "title: A car\nspeed_kmh: 30\nvehicle: {model: quarter}\nroad: {length_m: 100}\n"
NAMES = ("speed_m_s", "body_acc_0", "wheel_acc_0", "rattle_m_0")
N = 200


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    Path("car.yaml").write_text(CAR)
    return tmp_path


def json_messages() -> Iterator[dict[str, Any]]:
    for k in range(N):
        yield {
            "timestamp": {"sec": 100, "nsec": k * 5_000_000},
            "v": {"x": 36.0},
            "acc": [0.0, 0.1],
            "z": 0.0,
        }


def write_json_log(path: Path, schema: str = "car.Motion", image: bytes | None = None) -> None:
    """Log of another origin: JSON messages, and an image."""
    with path.open("wb") as stream:
        writer = Writer(stream)
        writer.start()
        number = writer.register_schema(schema, "jsonschema", b"{}")
        channel = writer.register_channel("/car", "json", number)
        for k, message in enumerate(json_messages()):
            writer.add_message(channel, k, json.dumps(message).encode(), k)
        if image is not None:
            number = writer.register_schema("foxglove.CompressedImage", "jsonschema", b"{}")
            channel = writer.register_channel("/front", "json", number)
            told = {"timestamp": {"sec": 100, "nsec": 500_000_000}, "data": base64.b64encode(image).decode()}
            writer.add_message(channel, 0, json.dumps(told).encode(), 0)
        writer.finish()


def write_mdf(path: Path, **units: str) -> None:
    times = np.arange(N) / 200
    with MDF(version="4.10") as file:
        file.append([Signal(np.ones(N), times, name=name, unit=units.get(name, "")) for name in NAMES])
        file.save(path, overwrite=True)


def write_table(path: Path, **columns: Any) -> None:
    table = {"time_s": np.arange(N) / 200} | {name: np.ones(N) for name in NAMES} | columns
    table = {name: values for name, values in table.items() if values is not None}
    rows = zip(*table.values(), strict=True)
    path.write_text("\n".join([",".join(table), *(",".join(map(str, row)) for row in rows)]))


def refusal(capsys: pytest.CaptureFixture[str], *arguments: str) -> str:
    assert main(["replay", *arguments, "--out", "out"]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert not Path("out").exists()
    return line


JSON_SIGNALS = [
    "--signal", "speed_m_s=/car.v.x [km/h]", "--signal", "body_acc_0=-acc.1", "--signal", "wheel_acc_0=acc.0",
    "--signal", "rattle_m_0=z", "--scenario", "car.yaml",
]  # fmt: skip


def test_a_log_of_json_messages_is_replayed(here: Path) -> None:
    done, picture = cv2.imencode(".jpg", np.full((384, 640, 3), 90, np.uint8))
    assert done
    write_json_log(here / "car.mcap", image=picture.tobytes())
    assert main(["replay", "car.mcap", *JSON_SIGNALS, "--out", "out"]) == 0
    told = json.loads((here / "out" / "summary.json").read_text())
    assert told["images"] == 1
    assert told["start_s"] == 100.0
    assert told["distance_m"] == pytest.approx(10.0 * (N - 1) / 200)


def test_a_foreign_log_without_images_names_what_it_has(here: Path, capsys: Any) -> None:
    write_json_log(here / "car.mcap")
    line = refusal(capsys, "car.mcap", *JSON_SIGNALS)
    assert "car.mcap: has no channel of foxglove.CompressedImage or sensor_msgs/msg/CompressedImage" in line
    assert "only 'car.Motion'" in line
    assert "holds no scenario; name one" in refusal(capsys, "car.mcap")


def test_a_missing_signal_is_named_with_a_way_on(here: Path, capsys: Any) -> None:
    write_json_log(here / "car.mcap")
    line = refusal(capsys, "car.mcap", "--scenario", "car.yaml")
    assert "car.mcap: has no channel 'speed_m_s' for the signal speed_m_s" in line
    assert "--signal speed_m_s=CHANNEL" in line
    write_table(here / "drive.csv", rattle_m_0=None)
    line = refusal(capsys, "drive.csv", "--scenario", "car.yaml")
    assert "drive.csv: has no channel 'rattle_m_0' for the signal rattle_m_0" in line


@pytest.mark.parametrize("suffix", ["mcap", "mf4"])
@pytest.mark.parametrize("share", [0.0, 0.02, 0.4, 0.9, 0.999])
def test_a_truncated_file_is_told_in_one_line(here: Path, capsys: Any, suffix: str, share: float) -> None:
    path = here / f"whole.{suffix}"
    write_json_log(path) if suffix == "mcap" else write_mdf(path)
    data = path.read_bytes()
    (here / f"cut.{suffix}").write_bytes(data[: int(share * len(data))])
    options = JSON_SIGNALS if suffix == "mcap" else ["--scenario", "car.yaml"]
    line = refusal(capsys, f"cut.{suffix}", *options)
    assert f"cut.{suffix}: " in line
    assert "truncated" in line or "it begins with b''" in line


def test_files_of_other_formats_are_told(here: Path, capsys: Any) -> None:
    for name in ("a.mcap", "a.mf4"):
        (here / name).write_bytes(b"GIF89a" * 100)
        assert f"{name}: " in refusal(capsys, name, "--scenario", "car.yaml")
    assert "must be a file .mcap, .mf4" in refusal(capsys, "a.bag", "--scenario", "car.yaml")


def test_an_unknown_unit_names_channel_and_allowed_units(here: Path, capsys: Any) -> None:
    write_mdf(here / "a.mf4", speed_m_s="furlong/h")
    line = refusal(capsys, "a.mf4", "--scenario", "car.yaml")
    assert "a.mf4: channel speed_m_s: the unit of speed_m_s must be one of m/s, km/h" in line


@pytest.mark.parametrize(
    ("columns", "told"),
    [
        ({"time_s": np.zeros(N)}, "channel speed_m_s: times must ascend"),
        ({"speed_m_s": np.full(N, np.nan)}, "channel speed_m_s must hold finite numbers"),
        ({"speed_m_s": ["fast"] * N}, "line 2 must hold numbers, got"),
        ({"time_s": None}, "has no column of times; must be one of time_s"),
    ],
)
def test_a_table_with_wrong_cells_is_told(here: Path, capsys: Any, columns: Any, told: str) -> None:
    write_table(here / "drive.csv", **columns)
    assert told in refusal(capsys, "drive.csv", "--scenario", "car.yaml")


@pytest.mark.parametrize(
    ("names", "index", "told"),
    [
        ([], None, "pictures: holds no images"),
        (["first.jpg"], None, "image names must be times in ms, such as 0001250.jpg, got 'first.jpg'"),
        ([], "time,name\n", "images.csv: the first line must be time_s,file"),
        ([], "time_s,file\nsoon,a.jpg\n", "images.csv: line 2 must be a time and a name"),
        ([], "time_s,file\n0.1,a.jpg\n", "a.jpg: cannot be read"),
        (["0000100.jpg"], None, "0000100.jpg: cannot be decoded as an image"),
        (["0900000.jpg"], None, "must hold images exposed during the signals, 0 ... 0.995 s"),
    ],
)
def test_a_wrong_folder_of_images_is_told(
    here: Path, capsys: Any, names: list[str], index: str | None, told: str
) -> None:
    write_table(here / "drive.csv")
    (here / "pictures").mkdir()
    for name in names:
        (here / "pictures" / name).write_bytes(b"no image")
    if index is not None:
        (here / "pictures" / "images.csv").write_text(index)
    assert told in refusal(capsys, "drive.csv", "--scenario", "car.yaml", "--images", "pictures")


def test_an_image_of_another_size_is_told_with_the_field(here: Path, capsys: Any) -> None:
    write_table(here / "drive.csv")
    (here / "pictures").mkdir()
    cv2.imwrite(str(here / "pictures" / "0000100.png"), np.zeros((48, 64, 3), np.uint8))
    line = refusal(capsys, "drive.csv", "--scenario", "car.yaml", "--images", "pictures")
    assert "camera.intrinsics.width_px x height_px = 640 x 384, got 64 x 48" in line


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("speed", "--signal must be NAME=CHANNEL, got 'speed'"),
        ("sped_m_s=v", "--signal 'sped_m_s': must be one of speed_m_s, body_acc_0"),
        ("speed_m_s=inf", "--signal: a constant must be finite, got 'inf'"),
    ],
)
def test_a_wrong_choice_of_channels_is_told(here: Path, capsys: Any, text: str, told: str) -> None:
    write_table(here / "drive.csv")
    assert told in refusal(capsys, "drive.csv", "--scenario", "car.yaml", "--signal", text)
