"""Protocol Buffers messages of numbers, described at run time, with the units in the channel's metadata."""

from collections.abc import Iterable, Mapping
from typing import Any

from foreride.scenarios.logs.libraries import library

PACKAGE = "foreride"
UNIT = "unit."
"""Prefix of a channel's metadata that hold the units of its fields, as `unit.pitch_rate`."""


def message_class(name: str, fields: Iterable[str], repeated: bool = False) -> Any:
    """Class of messages `PACKAGE.name` with fields of type double, or lists of them."""
    descriptor_pb2 = library("google.protobuf.descriptor_pb2", "MCAP")
    kinds = descriptor_pb2.FieldDescriptorProto
    file = descriptor_pb2.FileDescriptorProto(name=f"foreride/{name}.proto", package=PACKAGE)
    file.syntax = "proto3"
    message = file.message_type.add(name=name)
    for number, field in enumerate(fields, 1):
        label = kinds.LABEL_REPEATED if repeated else kinds.LABEL_OPTIONAL
        message.field.add(name=field, number=number, type=kinds.TYPE_DOUBLE, label=label)
    pool = library("google.protobuf.descriptor_pool", "MCAP").DescriptorPool()
    pool.Add(file)
    descriptor = pool.FindMessageTypeByName(f"{PACKAGE}.{name}")
    return library("google.protobuf.message_factory", "MCAP").GetMessageClass(descriptor)


def unit_metadata(units: Mapping[str, str]) -> dict[str, str]:
    """Metadata of a channel from the units of its fields."""
    return {f"{UNIT}{name}": unit for name, unit in units.items()}
