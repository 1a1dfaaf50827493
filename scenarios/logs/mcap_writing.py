"""Writing of a run as an MCAP file, for Foxglove and other readers of that format."""

import heapq
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any, NamedTuple

from foreride.files.writing.atomic import replaced
from foreride.scenarios.definition.clock import TICKS_PER_SECOND
from foreride.scenarios.logs import foxglove_messages as foxglove
from foreride.scenarios.logs.foxglove_messages import Timed
from foreride.scenarios.logs.libraries import library
from foreride.scenarios.logs.logged_run import RECORD, LoggedRun
from foreride.scenarios.logs.number_messages import message_class, unit_metadata
from foreride.scenarios.simulation.preview_log import PreviewLog
from foreride.scenarios.simulation.simulate import Run
from foreride.vehicle.state import signal_unit

SIGNALS_TOPIC, IMAGE_TOPIC, PREVIEW_TOPIC = "/vehicle/signals", "/camera/image", "/preview/right_front"
_PREVIEW_UNITS = {"distance_m": "m", "height_m": "m", "position_sigma_m": "m", "existence": "1"}


class Channel(NamedTuple):
    """Channel of a log: topic, message class, messages in order of time, and units of its fields."""

    topic: str
    kind: Any
    messages: Iterable[Timed]
    units: Mapping[str, str] = MappingProxyType({})


def write_mcap(logged: LoggedRun, path: Path) -> None:
    """Write a run as MCAP with Protocol Buffers messages, atomically; the same run gives the same bytes."""
    writer_module = library("mcap.writer", "MCAP")
    with replaced(path) as scratch, scratch.open("wb") as stream:
        writer = writer_module.Writer(stream)
        writer.start(library="foreride")
        writer.add_metadata(RECORD, logged.record())
        _write_messages(writer, channels(logged))
        writer.finish()


def channels(logged: LoggedRun) -> list[Channel]:
    """Channels of a run; those without a message are left out by the writer."""
    run, schema = logged.run, foxglove.schema
    camera = run.case.scenario.camera.intrinsics
    return [
        _signals(run),
        _previews(run.previews),
        Channel("/camera/calibration", schema("CameraCalibration"), foxglove.calibration(camera)),
        Channel(IMAGE_TOPIC, schema("CompressedImage"), foxglove.images(logged.images)),
        Channel("/camera/boxes", schema("ImageAnnotations"), foxglove.annotations(run.looks)),
        Channel("/tf", schema("FrameTransforms"), foxglove.transforms(run)),
        Channel("/preview/scene", schema("SceneUpdate"), foxglove.preview_lines(run)),
        Channel("/log", schema("Log"), foxglove.log_lines(run)),
    ]


def _signals(run: Run) -> Channel:
    names = [name for name in run.signals if name != "time_s"]
    kind, columns = message_class("Signals", names), [run.signals[name].tolist() for name in names]

    def messages() -> Iterator[Timed]:
        for tick, row in enumerate(zip(*columns, strict=True)):
            yield tick * 1_000_000_000 // TICKS_PER_SECOND, kind(**dict(zip(names, row, strict=True)))

    return Channel(SIGNALS_TOPIC, kind, messages(), {name: signal_unit(name) for name in names})


def _previews(log: PreviewLog) -> Channel:
    kind = message_class("RoadPreview", _PREVIEW_UNITS, repeated=True)

    def messages() -> Iterator[Timed]:
        rows = zip(log.time_s, log.height_m, log.position_sigma_m, log.existence, strict=True)
        for time_s, height, sigma, existence in rows:
            values = (log.distance_m, height, sigma, existence)
            yield round(float(time_s) * 1e9), kind(**dict(zip(_PREVIEW_UNITS, values, strict=True)))

    return Channel(PREVIEW_TOPIC, kind, messages(), _PREVIEW_UNITS)


def _write_messages(writer: Any, all_channels: list[Channel]) -> None:
    """Write the messages of all channels in order of time."""
    register_schema = library("mcap_protobuf.schema", "MCAP").register_schema
    streams = []
    for channel in all_channels:
        schema, units = register_schema(writer, channel.kind), unit_metadata(channel.units)
        number = writer.register_channel(channel.topic, "protobuf", schema, units)
        streams.append(_numbered(number, channel.messages))
    for time_ns, number, message in heapq.merge(*streams, key=lambda entry: entry[:2]):
        writer.add_message(number, time_ns, message.SerializeToString(deterministic=True), time_ns)


def _numbered(number: int, messages: Iterable[Timed]) -> Iterator[tuple[int, int, Any]]:
    return ((time_ns, number, message) for time_ns, message in messages)
