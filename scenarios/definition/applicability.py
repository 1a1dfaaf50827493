"""Faults and settings of a scenario that its car cannot have: refused by name rather than ignored."""

from collections.abc import Iterator, Sequence
from dataclasses import fields
from typing import Any

from foreride.controller.command_limits import DampingLimits, front_wheels
from foreride.controller.settings import ControllerSettings, FixedSettings, ForceSettings
from foreride.files.errors import InputError, shown
from foreride.scenarios.definition.faults import Fault, SensorFault
from foreride.vehicle.load import Car
from foreride.vehicle.plant.sensors import SensorInterface, SensorNoise

PER_WHEEL = ("body_acc", "wheel_acc", "rattle_m")
MOTIONS = {"pitch_rate": 2, "roll_rate": 3}
"""Degrees of freedom of a body that has such a motion."""


def require_applicable(
    car: Car, faults: Sequence[Fault], sensors: SensorNoise, settings: ControllerSettings
) -> None:
    """Raise InputError for what is set of a wheel, a motion or an actuator that the car does not have.

    A setting that has its default, or is zero, sets nothing.
    """
    for i, fault in enumerate(faults):
        if isinstance(fault, SensorFault):
            _require_sensor(car, fault, f"faults[{i}]")
    motions = [motion for motion, needed in MOTIONS.items() if len(car.generalised_mass) < needed]
    for block, values, defaults in (
        ("sensors", sensors, SensorNoise()),
        ("sensors.interface", sensors.interface, SensorInterface()),
    ):
        for name, value in _changed(values, defaults):
            for motion in motions:
                if name.startswith(motion) and value != 0.0:
                    raise _refusal(f"{block}.{name}", car, motion.removesuffix("_rate"), value)
    if car.wheels == 1:
        for law in ("fixed", "fixed_best"):
            for name, value in _changed(getattr(settings, law), FixedSettings()):
                if name.startswith("rear"):
                    raise _refusal(f"control.settings.{law}.{name}", car, "rear axle", value)
    _require_damping_in_range(car, settings)
    if car.actuator is None:
        for name, value in _changed(settings.mpc.force, ForceSettings()):
            raise _refusal(f"control.settings.mpc.force.{name}", car, "actuator", value)


def measures(car: Car, channel: str) -> bool:
    """Whether the car can move as this channel of its sensors measures."""
    return len(car.generalised_mass) >= MOTIONS.get(channel, 0)


def _require_sensor(car: Car, fault: SensorFault, location: str) -> None:
    if not measures(car, fault.channel):
        raise _refusal(f"{location}.channel", car, fault.channel.removesuffix("_rate"), fault.channel)
    highest = car.wheels - 1 if fault.channel in PER_WHEEL else 0
    if fault.wheel > highest:
        allowed = f"0 ... {highest}" if highest else "0"
        raise InputError(
            f"{location}.wheel must be {allowed} for {fault.channel} of a {car.kind}, got {fault.wheel}"
        )


def _require_damping_in_range(car: Car, settings: ControllerSettings) -> None:
    """Check the constant damping of each wheel, which any controller may fall back to, against its damper."""
    limits, fixed, best = DampingLimits.of(car), settings.fixed, settings.fixed_best
    for low, high, front in zip(limits.low, limits.high, front_wheels(car), strict=True):
        for name, value in (
            ("fixed.front_ns_m", fixed.front_ns_m) if front else ("fixed.rear_ns_m", fixed.rear_ns_m),
            ("fixed_best.front_ns_m", best.front_ns_m) if front else ("fixed_best.rear_ns_m", best.rear_ns_m),
            ("passive.damping_ns_m", settings.passive.damping_ns_m),
        ):
            if value is not None and not low <= value <= high:
                allowed = f"{low:g} ... {high:g} N·s/m, the range of the car's damper"
                raise InputError(f"control.settings.{name} must lie in {allowed}, got {value:g}")


def _changed(values: Any, defaults: Any) -> Iterator[tuple[str, Any]]:
    for item in fields(values):
        if (value := getattr(values, item.name)) != getattr(defaults, item.name):
            yield item.name, value


def _refusal(name: str, car: Car, part: str, value: Any) -> InputError:
    return InputError(f"{name} must be left out for a {car.kind} without {part}, got {shown(value)}")
