"""Recordings of ROS 2 in MCAP: signals and images with the times of their headers."""

import json
from pathlib import Path

import cv2
import numpy as np
import pytest
from mcap_ros2.writer import Writer

from foreride.scenarios.cli import main

LINE = "=" * 80
HEADER = f"""{LINE}
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
{LINE}
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
"""
IMAGE = f"std_msgs/Header header\nstring format\nuint8[] data\n{HEADER}"
MOTION = f"std_msgs/Header header\nfloat64 speed\nfloat64[3] acc\nfloat64 travel\n{HEADER}"
CAR = "title: A car\nspeed_kmh: 30\nvehicle: {model: quarter}\nroad: {length_m: 100}\n"
N, START_S = 200, 1_700_000_000


def header(k: int) -> dict[str, object]:
    return {"stamp": {"sec": START_S + k // 200, "nanosec": k % 200 * 5_000_000}, "frame_id": "car"}


@pytest.fixture
def log(tmp_path: Path) -> Path:
    done, picture = cv2.imencode(".jpg", np.full((384, 640, 3), 90, np.uint8))
    assert done
    path = tmp_path / "drive.mcap"
    with path.open("wb") as stream:
        writer = Writer(stream)
        motion = writer.register_msgdef("own_msgs/msg/Motion", MOTION)
        image = writer.register_msgdef("sensor_msgs/msg/CompressedImage", IMAGE)
        for k in range(N):
            told = {"header": header(k), "speed": 36.0, "acc": [0.0, 0.1, 0.2], "travel": 1.0}
            writer.write_message("/motion", motion, told, log_time=k)
        told = {"header": header(100), "format": "jpeg", "data": picture.tobytes()}
        writer.write_message("/front/compressed", image, told, log_time=0)
        writer.finish()
    (tmp_path / "car.yaml").write_text(CAR)
    return path


def test_signals_and_images_are_replayed_at_the_times_of_their_headers(log: Path) -> None:
    chosen = [
        "speed_m_s=speed [km/h]",
        "body_acc_0=/motion.acc.1",
        "wheel_acc_0=acc.0",
        "rattle_m_0=travel [mm]",
    ]
    options = [word for text in chosen for word in ("--signal", text)]
    out = log.parent / "out"
    assert (
        main(["replay", str(log), *options, "--scenario", str(log.parent / "car.yaml"), "--out", str(out)])
        == 0
    )
    told = json.loads((out / "summary.json").read_text())
    assert told["start_s"] == START_S
    assert told["duration_s"] == pytest.approx((N - 1) / 200)
    assert told["distance_m"] == pytest.approx(10.0 * (N - 1) / 200)
    (look,) = (out / "boxes.jsonl").read_text().splitlines()
    assert json.loads(look)["time_s"] == pytest.approx(0.5)
