"""Signals that the estimator needs, and the channels of a log that hold them, in any usual unit and sign."""

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from foreride.files.errors import InputError, nearest, shown
from foreride.files.reading.units import LENGTHS_M
from foreride.vehicle.load import GRAVITY_M_S2, Car
from foreride.vehicle.state import signal_unit

_ACCELERATIONS = {**dict.fromkeys(("m/s²", "m/s^2", "m/s2", "m/s/s"), 1.0), "g": GRAVITY_M_S2}
_RATES = {"rad/s": 1.0, **dict.fromkeys(("deg/s", "°/s"), math.pi / 180)}
_SPEEDS = {"m/s": 1.0, **dict.fromkeys(("km/h", "kph", "kmh"), 1 / 3.6), "mph": 0.44704}
UNITS: dict[str, Mapping[str, float]] = {
    "m/s²": _ACCELERATIONS, "rad/s": _RATES, "m/s": _SPEEDS, "m": LENGTHS_M,
}  # fmt: skip
"""Accepted units by the SI unit of a signal, as factors to it."""
_UNIT = re.compile(r"(.*?)\s*\[([^\[\]]*)\]\s*")


@dataclass(frozen=True)
class ChannelChoice:
    """Channel that holds a signal: its name, its unit if not as the log says, and its sign; or a constant."""

    channel: str
    unit: str | None = None
    sign: float = 1.0
    constant: float | None = None


def split_unit(text: str) -> tuple[str, str | None]:
    """Name and unit of `name [unit]`; None without one."""
    match = _UNIT.fullmatch(text)
    return (match[1].strip(), match[2].strip()) if match else (text.strip(), None)


def needed_signals(car: Car) -> list[str]:
    """Names of the signals that an estimator of this car takes, one of each kind per wheel."""
    names = ["speed_m_s"]
    names += ["pitch_rate"] if len(set(car.axle_x_m)) > 1 else []
    names += ["roll_rate"] if len(set(car.wheel_y_m)) > 1 and car.wheels > 2 else []
    per_wheel = ("body_acc", "wheel_acc", "rattle_m")
    return names + [f"{kind}_{wheel}" for kind in per_wheel for wheel in range(car.wheels)]


def parse_choices(texts: Sequence[str], needed: Sequence[str]) -> dict[str, ChannelChoice]:
    """Channel of each needed signal: as `NAME=CHANNEL [unit]` says, by default the channel of its name.

    A minus before the channel reverses its sign; a number stands for a constant in SI units.
    """
    choices = {name: ChannelChoice(name) for name in needed}
    for text in texts:
        name, equals, value = text.partition("=")
        if not equals or not value.strip():
            raise InputError(f"--signal must be NAME=CHANNEL, got {shown(text)}")
        if name not in choices:
            known = f"{', '.join(needed)}{nearest(name, needed)}"
            raise InputError(f"--signal {shown(name)}: must be one of {known}")
        choices[name] = _choice(value.strip())
    return choices


def _choice(text: str) -> ChannelChoice:
    try:
        constant = float(text)
    except ValueError:
        channel, unit = split_unit(text)
        sign = -1.0 if channel.startswith("-") else 1.0
        return ChannelChoice(channel.removeprefix("-").strip(), unit, sign)
    if not math.isfinite(constant):
        raise InputError(f"--signal: a constant must be finite, got {shown(text)}")
    return ChannelChoice("", constant=constant)


def factor(signal: str, unit: str | None, place: str) -> float:
    """Factor from a unit to that of the signal; no unit means SI. InputError naming `place` for any other."""
    accepted = UNITS[signal_unit(signal)]
    if unit is None or unit == "":
        return 1.0
    if unit not in accepted:
        raise InputError(
            f"{place}: the unit of {signal} must be one of {', '.join(accepted)}, got {shown(unit)}; "
            f"tell it as --signal '{signal}=CHANNEL [unit]'"
        )
    return accepted[unit]
