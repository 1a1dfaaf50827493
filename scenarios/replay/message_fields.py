"""Fields of decoded messages, Protocol Buffers or JSON: their numbers by dotted names, and their time."""

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
    elif hasattr(value, "DESCRIPTOR"):
        for field in value.DESCRIPTOR.fields:
            if field.message_type is None or field.name != "timestamp":
                yield from _numbers(
                    getattr(value, field.name), f"{name}.{field.name}" if name else field.name
                )
    elif not isinstance(value, str | bytes) and hasattr(value, "__len__"):
        for index, inner in enumerate(value):
            yield from _numbers(inner, f"{name}.{index}")


def time_ns(message: Any, logged_ns: int) -> int:
    """Time of a message: its field `timestamp` where it has one, else when it was logged."""
    stamp: Any = (
        message.get("timestamp") if isinstance(message, dict) else getattr(message, "timestamp", None)
    )
    if isinstance(stamp, dict) and isinstance(stamp.get("sec"), int):
        return int(stamp["sec"]) * _NS + int(stamp.get("nsec", 0))
    return int(stamp.ToNanoseconds()) if hasattr(stamp, "ToNanoseconds") else logged_ns
