"""Reading of MCAP files: numbers in messages of Protocol Buffers, JSON or ROS 2, and compressed images.

A channel of numbers is a field of a topic's messages, such as `/vehicle/signals.pitch_rate`, or
`pitch_rate` if one topic alone has such a field; entries of lists count from 0: `/imu.acceleration.2`.
"""

import base64
import json
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from foreride.files.errors import InputError, shown
from foreride.files.reading.regular_file import reading
from foreride.scenarios.logs.libraries import library
from foreride.scenarios.logs.logged_run import RECORD, recorded_scenario
from foreride.scenarios.logs.number_messages import UNIT
from foreride.scenarios.replay.message_fields import numbers, time_ns
from foreride.scenarios.replay.recording import RecordedImage, Series

_MAGIC = b"\x89MCAP0\r\n"
IMAGE_SCHEMAS = ("foxglove.CompressedImage", "sensor_msgs/msg/CompressedImage")
ENCODINGS = ("protobuf", "json", "cdr")
"""Encodings of messages that are read; cdr is that of ROS 2."""


class McapLog:
    """MCAP file with an index, which files cut short lack; only messages in use are held in memory."""

    def __init__(self, path: Path) -> None:
        self.path = path
        with reading(path), path.open("rb") as stream:
            start = stream.read(len(_MAGIC))
            stream.seek(max(0, path.stat().st_size - len(_MAGIC)))
            end = stream.read()
        if start != _MAGIC:
            raise InputError(f"{path}: must be an MCAP file, it begins with {start!r}")
        if end != _MAGIC:
            raise InputError(
                f"{path}: the file is truncated, it does not end as MCAP files do (`mcap recover`)"
            )

    @contextmanager
    def _opened(self) -> Iterator[Any]:
        make_reader = library("mcap.reader", "MCAP").make_reader
        modules = (library(name, "MCAP") for name in ("mcap_protobuf.decoder", "mcap_ros2.decoder"))
        factories = [*(module.DecoderFactory() for module in modules), _JsonDecoders()]
        with reading(self.path), self.path.open("rb") as stream:
            yield make_reader(stream, validate_crcs=True, decoder_factories=factories)

    @cached_property
    def _topics(self) -> dict[str, tuple[str, str, dict[str, str]]]:
        """Encoding of the messages, name of their schema, and metadata, by topic."""
        with self._opened() as reader:
            summary = reader.get_summary()
            if summary is None:
                raise InputError(f"{self.path}: the file is truncated, it has no index")
            schemas = {number: schema.name for number, schema in summary.schemas.items()}
            return {
                channel.topic: (
                    channel.message_encoding,
                    schemas.get(channel.schema_id, ""),
                    channel.metadata,
                )
                for channel in summary.channels.values()
            }

    @cached_property
    def _fields(self) -> dict[str, tuple[str, str]]:
        """Topic and field by the name of a channel; unique fields also by their own name."""
        full, by_field = {}, defaultdict(list)
        for topic in self._number_topics():
            first = next(iter(self._messages([topic])), None)
            for field in numbers(first[1]) if first else ():
                full[f"{topic}.{field}"] = (topic, field)
                by_field[field].append((topic, field))
        return {field: places[0] for field, places in by_field.items() if len(places) == 1} | full

    def _number_topics(self) -> list[str]:
        known = [topic for topic, (kind, *_) in self._topics.items() if kind in ENCODINGS]
        if not known:
            kinds = ", ".join(sorted({kind for kind, *_ in self._topics.values()})) or "no messages"
            raise InputError(f"{self.path}: messages must be of encoding {', '.join(ENCODINGS)}, got {kinds}")
        return [topic for topic in known if self._topics[topic][1] not in IMAGE_SCHEMAS]

    def _messages(self, topics: list[str]) -> Iterator[tuple[int, Any, str]]:
        """Time (ns), message and topic."""
        with self._opened() as reader:
            for _, channel, message, decoded in reader.iter_decoded_messages(topics=topics):
                yield time_ns(decoded, message.log_time), decoded, channel.topic

    def channels(self) -> Sequence[str]:
        """Names of the fields that are numbers."""
        return list(self._fields)

    def series(self, channels: Iterable[str]) -> Mapping[str, Series]:
        """Samples of the fields, read in one pass."""
        places = {name: self._fields[name] for name in channels}
        times: dict[str, list[int]] = {name: [] for name in places}
        values: dict[str, list[float]] = {name: [] for name in places}
        for when, decoded, topic in self._messages(list({topic for topic, _ in places.values()})):
            found = numbers(decoded)
            for name, (its_topic, field) in places.items():
                if its_topic == topic and field in found:
                    times[name].append(when)
                    values[name].append(found[field])
        return {
            name: Series(np.array(times[name]) / 1e9, np.array(values[name]), self._unit(*places[name]))
            for name in places
        }

    def _unit(self, topic: str, field: str) -> str | None:
        return self._topics[topic][2].get(f"{UNIT}{field}")

    def scenario(self) -> dict[str, Any] | None:
        """Fields of the scenario in the metadata."""
        with self._opened() as reader:
            for record in reader.iter_metadata():
                if record.name == RECORD:
                    return recorded_scenario(record.metadata, f"{self.path}: metadata {RECORD}")
        return None

    def images(self, topic: str | None) -> Iterator[RecordedImage]:
        """Images in order of time: of a topic, or of the only one that has images."""
        topic = self._image_topic(topic)
        for when, decoded, _ in self._messages([topic]):
            data = decoded["data"] if isinstance(decoded, dict) else decoded.data
            content = base64.b64decode(data) if isinstance(data, str) else bytes(data)
            yield RecordedImage(when / 1e9, content, f"{self.path}: {topic} at {when / 1e9:.3f} s")

    def _image_topic(self, wanted: str | None) -> str:
        topics = [topic for topic, (_, schema, _) in self._topics.items() if schema in IMAGE_SCHEMAS]
        if not topics:
            kinds = ", ".join(sorted({schema for _, schema, _ in self._topics.values()}))
            raise InputError(
                f"{self.path}: has no channel of {' or '.join(IMAGE_SCHEMAS)}, only {shown(kinds)}"
            )
        if wanted in topics:
            return str(wanted)
        if wanted is not None or len(topics) > 1:
            raise InputError(f"--images must be one of {', '.join(topics)}, got {shown(wanted)}")
        return topics[0]


class _JsonDecoders:
    """Decoders of JSON messages, as `mcap.reader` takes them."""

    def decoder_for(self, message_encoding: str, schema: Any) -> Any:
        """Decoder of JSON; None for another encoding."""
        return json.loads if message_encoding == "json" else None
