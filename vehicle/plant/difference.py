"""Difference between the simulated car and the car that the controllers know.

Parameters vary from car to car and with age and load, and no controller knows them exactly. A difference
changes the simulated car, its valves, its sensors and the command's way to it; models, observer and laws stay
with the known ones.
"""

from collections import deque
from dataclasses import dataclass, fields, replace
from typing import Annotated, Any

import numpy as np
from annotated_types import Interval
from numpy.typing import NDArray

from foreride.files.errors import InputError
from foreride.files.reading.ranges import Checked, Share
from foreride.vehicle.dampers.damper import ScaledDamper, each_damper
from foreride.vehicle.load import Car
from foreride.vehicle.plant.sensors import Measurement, channel_layout
from foreride.vehicle.quantities import Lag
from foreride.vehicle.state import VehicleState

Array = NDArray[np.float64]
Ratio = Annotated[float, Interval(ge=0.2, le=5.0), "1"]
Bias = Annotated[float, Interval(ge=-10.0, le=10.0), "m/s²"]

_SCALED = {
    "sprung_mass_ratio": ("sprung_mass_kg", "body_mass_kg", "pitch_inertia_kg_m2", "roll_inertia_kg_m2"),
    "unsprung_mass_ratio": ("unsprung_mass_kg",),
    "spring_ratio": ("spring_n_m", "spring_n_m3", "anti_roll_n_m"),
    "tyre_ratio": ("tyre_n_m",),
}


@dataclass(frozen=True)
class PlantDifference(Checked):
    """Simulated car where it differs from the known one; every `*_ratio` is its value over the known value.

    sprung_mass_ratio: of mass and inertias, at the same ride height. spring_ratio: of springs and anti-roll
    bars. rebound_force_ratio, compression_force_ratio: of the damper's force where it pulls the body down and
    pushes it up. damper_lag_s: replaces the known lag. full_stroke_s: time in which the valve moves from one
    end of its range to the other, None for the known one. hysteresis: width of the valve's play, as a
    share of its range. actuation_delay_s: in addition to `control.delay_s`. sensor_delay_readings: readings
    arrive so much later. sensor_rate_hz: rate at which readings are renewed, None for each time they are
    read. *_bias_*: added to every reading of the channel.
    """

    sprung_mass_ratio: Ratio = 1.0
    unsprung_mass_ratio: Ratio = 1.0
    spring_ratio: Ratio = 1.0
    tyre_ratio: Ratio = 1.0
    rebound_force_ratio: Ratio = 1.0
    compression_force_ratio: Ratio = 1.0
    damper_lag_s: Lag | None = None
    full_stroke_s: Annotated[float, Interval(ge=0.0, le=1.0), "s"] | None = None
    hysteresis: Share = 0.0
    actuation_delay_s: Annotated[float, Interval(ge=0.0, le=0.2), "s"] = 0.0
    sensor_delay_readings: Annotated[int, Interval(ge=0, le=50), "readings"] = 0
    sensor_rate_hz: Annotated[int, Interval(ge=10, le=1000), "Hz"] | None = None
    body_acc_bias_m_s2: Bias = 0.0
    wheel_acc_bias_m_s2: Bias = 0.0
    rattle_bias_m: Annotated[float, Interval(ge=-0.1, le=0.1), "m"] = 0.0
    pitch_rate_bias_rad_s: Annotated[float, Interval(ge=-1.0, le=1.0), "rad/s"] = 0.0

    def applied(self, car: Car) -> Car:
        """The simulated car. Raises InputError for one that is not plausible."""
        if car.spring_table is not None and (self.spring_ratio, self.sprung_mass_ratio) != (1.0, 1.0):
            raise InputError("spring_ratio and sprung_mass_ratio must be 1 for a car with a spring_table")
        changed: dict[str, Any] = {}
        own = {item.name for item in fields(car)}
        for ratio, names in _SCALED.items():
            factor = getattr(self, ratio)
            if factor != 1.0:
                changed |= {name: _times(getattr(car, name), factor) for name in names if name in own}
        if self.damper_lag_s is not None:
            changed["damper_lag_s"] = self.damper_lag_s
        if (self.rebound_force_ratio, self.compression_force_ratio) != (1.0, 1.0):
            ratios = self.rebound_force_ratio, self.compression_force_ratio
            changed["damper"] = each_damper(car.damper, lambda damper: ScaledDamper(*ratios, base=damper))
        return replace(car, **changed) if changed else car


def _times(value: Any, factor: float) -> Any:
    return tuple(one * factor for one in value) if isinstance(value, tuple) else value * factor


class Valves:
    """Valves of all dampers: the setting follows the command with play and a limited rate.

    The play of the spool is its friction, which holds the setting until the command has moved by half the
    width.
    """

    def __init__(self, car: Car, full_stroke_s: float, hysteresis: float) -> None:
        span = np.array([corner.damping_max_ns_m - corner.damping_min_ns_m for corner in car.corners])
        self._play = 0.5 * hysteresis * span
        self._rate = span / full_stroke_s if full_stroke_s else np.full(len(span), np.inf)
        self._setting = np.array([corner.damping_passive_ns_m for corner in car.corners])
        self.ideal = not (full_stroke_s or hysteresis)

    def advance(self, command: Array, step_s: float) -> Array:
        """The command with its settings (wheels first) replaced by those that the valves reach in a step."""
        asked = command[: len(self._setting)]
        target = np.clip(self._setting, asked - self._play, asked + self._play)
        most = self._rate * step_s
        self._setting = np.clip(target, self._setting - most, self._setting + most)
        return np.concatenate([self._setting, command[len(self._setting) :]])


class DeliveredReadings:
    """Sensor readings as they arrive: with bias, late, and renewed at the sensors' own rate."""

    def __init__(self, sensors: Any, difference: PlantDifference, wheels: int) -> None:
        self._sensors, self._wheels = sensors, wheels
        layout, bias = channel_layout(wheels), np.zeros(3 * wheels + 3)
        bias[layout.body_acc] = difference.body_acc_bias_m_s2
        bias[layout.wheel_acc] = difference.wheel_acc_bias_m_s2
        bias[layout.rattle] = difference.rattle_bias_m
        bias[3 * wheels] = difference.pitch_rate_bias_rad_s
        self._bias = bias
        self._period_s = 1.0 / difference.sensor_rate_hz if difference.sensor_rate_hz else 0.0
        self._renewed_s = -np.inf
        self._waiting: deque[Array] = deque(maxlen=difference.sensor_delay_readings + 1)
        self._held = bias
        self._as_measured = not bias.any() and self._period_s == 0.0 and self._waiting.maxlen == 1

    @property
    def offset(self) -> Array:
        """Offset of each channel, in the order of `Measurement.channels`."""
        return np.asarray(self._sensors.offset + self._bias)

    def measure(self, state: VehicleState) -> Measurement:
        """Return the reading that arrives at the present state's time."""
        measured: Measurement = self._sensors.measure(state)
        if self._as_measured:
            return measured
        reading = measured.channels() + self._bias
        if state.time_s >= self._renewed_s + self._period_s - 1e-9:
            self._renewed_s, self._held = state.time_s, reading
        self._waiting.append(self._held)
        return Measurement.of_channels(state.time_s, self._waiting[0])
