"""MCAP files of runs, opened by the readers of the format: images, boxes, transforms, signals, preview."""

import io
import json
from collections import defaultdict
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory
from scipy.spatial.transform import Rotation

from foreride.road.camera.pinhole import CameraPose, pose_of
from foreride.scenarios.logs.logged_run import LoggedRun, read_logged
from foreride.scenarios.logs.mcap_writing import write_mcap
from foreride.scenarios.perceptions.camera import nominal_mount
from foreride.scenarios.runs.write import frame_name
from foreride.vehicle.state import signal_unit


@pytest.fixture(scope="module")
def logged(run_folder: Path) -> LoggedRun:
    return read_logged(run_folder)


@pytest.fixture(scope="module")
def content(logged: LoggedRun, tmp_path_factory: pytest.TempPathFactory) -> bytes:
    path = tmp_path_factory.mktemp("mcap") / "run.mcap"
    write_mcap(logged, path)
    return path.read_bytes()


@pytest.fixture(scope="module")
def messages(content: bytes) -> dict[str, list[tuple[float, Any]]]:
    """Time (s) and message of each channel, in the order of the file."""
    read = defaultdict(list)
    reader = make_reader(io.BytesIO(content), validate_crcs=True, decoder_factories=[DecoderFactory()])
    for _, channel, message, decoded in reader.iter_decoded_messages():
        read[channel.topic].append((message.log_time / 1e9, decoded))
    return read


def test_signals_are_those_of_the_run_with_their_units(
    logged: LoggedRun, content: bytes, messages: dict[str, Any]
) -> None:
    read = messages["/vehicle/signals"]
    signals = logged.run.signals
    assert np.allclose([time_s for time_s, _ in read], signals["time_s"], rtol=0, atol=1e-9)
    for name in ("seat_acc_0", "tyre_force_1", "x_m"):
        assert [getattr(message, name) for _, message in read] == signals[name].tolist()
    summary = make_reader(io.BytesIO(content)).get_summary()
    assert summary is not None
    channel = next(channel for channel in summary.channels.values() if channel.topic == "/vehicle/signals")
    assert channel.metadata == {f"unit.{name}": signal_unit(name) for name in signals if name != "time_s"}


def test_images_are_the_files_of_the_run_folder(
    run_folder: Path, logged: LoggedRun, messages: dict[str, Any]
) -> None:
    images = messages["/camera/image"]
    assert len(images) == len(logged.run.looks) > 5
    for (time_s, message), look in zip(images, logged.run.looks, strict=True):
        assert time_s == pytest.approx(look.tick / 1000)
        assert message.timestamp.ToNanoseconds() == look.tick * 1_000_000
        assert message.data == (run_folder / frame_name(look.tick)).read_bytes()
    assert images[0][1].format == "jpeg"
    assert cv2.imdecode(np.frombuffer(images[0][1].data, np.uint8), cv2.IMREAD_COLOR).shape == (384, 640, 3)


def test_annotations_frame_the_boxes(logged: LoggedRun, messages: dict[str, Any]) -> None:
    found = 0
    for (_, message), look in zip(messages["/camera/boxes"], logged.run.looks, strict=True):
        assert len(message.points) == len(message.texts) == len(look.detections)
        for outline, text, box in zip(message.points, message.texts, look.detections.boxes, strict=True):
            corners = np.array([(point.x, point.y) for point in outline.points])
            assert np.allclose([*corners.min(0), *corners.max(0)], box)
            assert text.text.startswith(("speed_bump", "pothole"))
            found += 1
    assert found > 0


def test_transforms_lead_from_the_road_to_the_camera(logged: LoggedRun, messages: dict[str, Any]) -> None:
    mount, signals = nominal_mount(logged.run.case.scenario), logged.run.signals
    for time_s, message in messages["/tf"][::20]:
        tick = round(1000 * time_s)
        position, attitude = np.zeros(3), Rotation.identity()
        parents = [transform.parent_frame_id for transform in message.transforms]
        assert parents == ["road", "car", "body"]
        for transform in message.transforms:
            position = position + attitude.apply([getattr(transform.translation, axis) for axis in "xyz"])
            attitude = attitude * Rotation.from_quat([getattr(transform.rotation, axis) for axis in "xyzw"])
        motion = (float(signals[name][tick]) for name in ("x_m", "heave_m", "pitch_rad"))
        pose: CameraPose = pose_of(mount, *motion)
        assert np.allclose(position, pose.position)
        assert np.allclose(attitude.apply([0.0, 0.0, 1.0]), pose.rotation[:, 0])  # optical axis: forward
        assert np.allclose(attitude.apply([1.0, 0.0, 0.0]), -pose.rotation[:, 1])  # right


def test_preview_comes_as_numbers_and_as_a_line(logged: LoggedRun, messages: dict[str, Any]) -> None:
    log = logged.run.previews
    numbers, lines = messages["/preview/right_front"], messages["/preview/scene"]
    assert len(numbers) == len(lines) == len(log)
    assert np.allclose(numbers[-1][1].height_m, log.height_m[-1])
    points = lines[-1][1].entities[0].lines[0].points
    front_m = max(logged.run.case.scenario.vehicle.parameters.axle_x_m)
    assert np.allclose([point.x for point in points], front_m + log.distance_m, atol=1e-6)
    assert np.allclose([point.z for point in points], log.height_m[-1])


def test_the_scenario_and_the_metrics_stand_in_the_file(logged: LoggedRun, content: bytes) -> None:
    (record,) = make_reader(io.BytesIO(content)).iter_metadata()
    assert json.loads(record.metadata["metrics"]) == logged.run.metrics
    assert json.loads(record.metadata["scenario"])["vehicle"]["model"] == "half"


def test_the_same_run_gives_the_same_bytes(logged: LoggedRun, content: bytes, tmp_path: Path) -> None:
    write_mcap(logged, tmp_path / "again.mcap")
    assert (tmp_path / "again.mcap").read_bytes() == content
