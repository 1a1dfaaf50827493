"""Fields of decoded messages, of Protocol Buffers, JSON or ROS 2: numbers by dotted names, and the time."""

from collections.abc import Iterator
from typing import Any

_NS = 1_000_000_000


def numbers(message: Any) -> dict[str, float]:
    """Numbers in a message by the dotted name of their field; entries of lists by their index."""
    return dict(_numbers(message, ""))


def _numbers(value: Any, name: str) -> Iterator[tuple[str, float]]:
    if isinstance(value, bool | int | float):
        yield name, float(value)
    elif isinstance(value, dict):
        for key, inner in value.items():
            yield from _numbers(inner, f"{name}.{key}" if name else str(key))
    elif names := _field_names(value):
        for field in names:
            yield from _numbers(getattr(value, field), f"{name}.{field}" if name else field)
    elif not isinstance(value, str | bytes) and hasattr(value, "__len__"):
        for index, inner in enumerate(value):
            yield from _numbers(inner, f"{name}.{index}")


def _field_names(value: Any) -> list[str]:
    """Names of the fields of a message or of one inside it; none of a time, which is no number."""
    if hasattr(value, "DESCRIPTOR"):
        is_time = value.DESCRIPTOR.full_name == "google.protobuf.Timestamp"
        return [] if is_time else [field.name for field in value.DESCRIPTOR.fields]
    return list(getattr(value, "__slots__", ()))  # ROS 2


def time_ns(message: Any, logged_ns: int) -> int:
    """Time of a message: its `timestamp` or `header.stamp` where it has one, else when it was logged."""
    stamp = _field(message, "timestamp") or _field(_field(message, "header"), "stamp")
    if hasattr(stamp, "ToNanoseconds"):
        return int(stamp.ToNanoseconds())
    seconds, fractions = _field(stamp, "sec"), _field(stamp, "nsec") or _field(stamp, "nanosec") or 0
    return int(seconds) * _NS + int(fractions) if isinstance(seconds, int) else logged_ns


def _field(message: Any, name: str) -> Any:
    return message.get(name) if isinstance(message, dict) else getattr(message, name, None)
