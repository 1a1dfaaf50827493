"""Recording of a drive: vehicle signals over time, and camera images with their times of exposure."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from foreride.files.errors import InputError, nearest, shown
from foreride.scenarios.replay.channels import ChannelChoice, factor

Array = NDArray[np.float64]


class Series(NamedTuple):
    """Samples of a channel: times, s, values, and the unit that the log tells, if any."""

    times_s: Array
    values: Array
    unit: str | None


class RecordedImage(NamedTuple):
    """Encoded image: time of its exposure, s, content of its file, and its name for messages."""

    time_s: float
    data: bytes
    name: str


class Log(Protocol):
    """Reader of a log of one format."""

    @property
    def path(self) -> Path:
        """Path of the log."""

    def channels(self) -> Sequence[str]:
        """Names of the channels of numbers."""

    def series(self, channels: Iterable[str]) -> Mapping[str, Series]:
        """Samples of some channels, all of them of `channels()`."""

    def scenario(self) -> dict[str, Any] | None:
        """Fields of the scenario that the log was written of; None for a log of another origin."""

    def images(self, topic: str | None) -> Iterator[RecordedImage]:
        """Images in order of time: of a topic, or of the only one that has images."""


@dataclass(frozen=True)
class Signals:
    """Signals in SI units on one grid of times: (n,) each. start_s: the log's time at the grid's zero."""

    times_s: Array
    values: dict[str, Array]
    start_s: float


def read_signals(log: Log, choices: Mapping[str, ChannelChoice], rate_hz: int) -> Signals:
    """Signals interpolated at `rate_hz` over the time that all channels share. Raises InputError."""
    wanted = {name: choice for name, choice in choices.items() if choice.constant is None}
    _check_presence(log, wanted)
    read = log.series({choice.channel for choice in wanted.values()})
    for choice in wanted.values():
        _check(read[choice.channel], f"{log.path}: channel {choice.channel}")
    if not wanted:
        raise InputError(f"{log.path}: at least one signal must come from the log, all are constants")
    start_s = max(series.times_s[0] for series in read.values())
    end_s = min(series.times_s[-1] for series in read.values())
    count = int(np.floor((end_s - start_s) * rate_hz + 1e-6)) + 1
    if count < 2:
        raise InputError(
            f"{log.path}: the channels share no time: one begins at {start_s:g} s, one ends at {end_s:g} s"
        )
    times_s = np.arange(count) / rate_hz
    values = {}
    for name, choice in choices.items():
        if choice.constant is not None:
            values[name] = np.full(count, choice.constant)
            continue
        series = read[choice.channel]
        scale = factor(name, choice.unit or series.unit, f"{log.path}: channel {choice.channel}")
        values[name] = choice.sign * scale * np.interp(times_s, series.times_s - start_s, series.values)
    return Signals(times_s, values, float(start_s))


def _check_presence(log: Log, wanted: Mapping[str, ChannelChoice]) -> None:
    """Raise InputError for the signals whose channel the log lacks."""
    present = log.channels()
    missing = {name: choice.channel for name, choice in wanted.items() if choice.channel not in present}
    if missing:
        name, channel = next(iter(missing.items()))
        others = f" ({len(missing)} such signals: {', '.join(missing)})" if len(missing) > 1 else ""
        raise InputError(
            f"{log.path}: has no channel {shown(channel)} for the signal {name}{others}; name it as --signal "
            f"{name}=CHANNEL, or give a constant as --signal {name}=0{nearest(channel, present)}"
        )


def _check(series: Series, place: str) -> None:
    if len(series.times_s) < 2:
        raise InputError(f"{place} must have at least 2 samples, got {len(series.times_s)}")
    if not (np.isfinite(series.times_s).all() and np.isfinite(series.values).all()):
        raise InputError(f"{place} must hold finite numbers, got NaN or infinity")
    backwards = np.flatnonzero(np.diff(series.times_s) <= 0.0)
    if len(backwards):
        at = series.times_s[backwards[0]]
        raise InputError(f"{place}: times must ascend, they do not after {at:g} s")
