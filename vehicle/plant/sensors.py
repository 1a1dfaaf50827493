"""Vehicle sensors: true signals with noise, offsets and, optionally, quantisation, delay and dropout.

Default values, each typical of a class of parts:

* body accelerometer and gyros of pitch and roll: automotive six-axis MEMS module (±8 g, ±125 °/s); noise
  densities of 60 µg/√Hz and 5 m°/s/√Hz; residual offsets after standstill calibration, 3 mg and 0.05 °/s
* wheel accelerometer: automotive high-g MEMS (±120 g); 1 mg/√Hz, offset 50 mg
* rattle: Hall-effect level sensor on a linkage, ±100 mm; 0.2 mm noise, 1 mm zero error
* speed: toothed-ring wheel-speed sensor; 0.02 m/s noise, 0.3 % error of the rolling radius

`CATALOGUE_RESOLUTION` holds the resolution of digital outputs of such parts: 16-bit inertial modules like
Bosch's SMI230 (0.244 mg at ±8 g, 0.0038 °/s at ±125 °/s), high-g accelerometers like Analog Devices' ADXL375
(49 mg), a 12-bit level sensor over 200 mm.
"""

from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass, field, fields
from functools import cached_property, lru_cache
from typing import Annotated, Any, NamedTuple

import numpy as np
from annotated_types import Interval
from numpy.typing import NDArray

from foreride.files.reading.ranges import Checked
from foreride.vehicle.load import GRAVITY_M_S2
from foreride.vehicle.state import VehicleState

Array = NDArray[np.float64]


Acceleration = Annotated[float, Interval(ge=0.0, le=100.0), "m/s²"]
AccelerationDensity = Annotated[float, Interval(ge=0.0, le=10.0), "m/s²/√Hz"]
Rate = Annotated[float, Interval(ge=0.0, le=10.0), "rad/s"]
RateDensity = Annotated[float, Interval(ge=0.0, le=1.0), "rad/s/√Hz"]
Speed = Annotated[float, Interval(ge=0.0, le=10.0), "m/s"]
Travel = Annotated[float, Interval(ge=0.0, le=1.0), "m"]


@dataclass(frozen=True)
class SensorInterface(Checked):
    """Interface from the sensors to the controller: quantisation, delay and dropout.

    *_step: resolution of a reading, 0 for none. delay_readings: delay of all channels, in readings. dropout:
    probability that a channel of a reading is lost; the last one received is then held.
    """

    body_acc_step_m_s2: Acceleration = 0.0
    wheel_acc_step_m_s2: Acceleration = 0.0
    rattle_step_m: Travel = 0.0
    pitch_rate_step_rad_s: Rate = 0.0
    roll_rate_step_rad_s: Rate = 0.0
    speed_step_m_s: Speed = 0.0
    delay_readings: Annotated[int, Interval(ge=0, le=200), "readings"] = 0
    dropout: Annotated[float, Interval(ge=0.0, lt=1.0), "1"] = 0.0


CATALOGUE_RESOLUTION = SensorInterface(
    body_acc_step_m_s2=0.244e-3 * GRAVITY_M_S2,
    wheel_acc_step_m_s2=49e-3 * GRAVITY_M_S2,
    rattle_step_m=0.2 / 4096,
    pitch_rate_step_rad_s=float(np.radians(0.0038)),
    roll_rate_step_rad_s=float(np.radians(0.0038)),
    speed_step_m_s=0.01,
)


@dataclass(frozen=True)
class SensorNoise(Checked):
    """Standard deviations of noise (per sample, within the sensor bandwidth) and of offsets (per car)."""

    body_density_m_s2: AccelerationDensity = 60e-6 * GRAVITY_M_S2
    body_offset_m_s2: Acceleration = 3e-3 * GRAVITY_M_S2
    wheel_density_m_s2: AccelerationDensity = 1e-3 * GRAVITY_M_S2
    wheel_offset_m_s2: Acceleration = 50e-3 * GRAVITY_M_S2
    pitch_rate_density_rad_s: RateDensity = float(np.radians(5e-3))
    pitch_rate_offset_rad_s: Rate = float(np.radians(0.05))
    roll_rate_density_rad_s: RateDensity = float(np.radians(5e-3))
    roll_rate_offset_rad_s: Rate = float(np.radians(0.05))
    rattle_m: Travel = 2e-4
    rattle_offset_m: Travel = 1e-3
    speed_m_s: Speed = 0.02
    speed_scale: Annotated[float, Interval(ge=0.0, le=0.2), "1"] = 0.003
    bandwidth_hz: Annotated[float, Interval(ge=0.0, le=10_000.0), "Hz"] = 200.0  # of accelerometers and gyro
    interface: SensorInterface = field(default_factory=SensorInterface)


_ZERO_NOISE: dict[str, Any] = {item.name: 0.0 for item in fields(SensorNoise) if item.name != "interface"}
NO_NOISE = SensorNoise(**_ZERO_NOISE)


@dataclass(frozen=True, eq=False)
class Measurement:
    """Reading of all sensors at one instant; accelerations are zero at standstill; w wheels, front first."""

    time_s: float
    body_acc: Array  # (w,) above each wheel, m/s²
    wheel_acc: Array  # (w,) m/s²
    rattle_m: Array  # (w,) body minus wheel
    pitch_rate: float  # rad/s, positive nose-down
    speed_m_s: float
    roll_rate: float = 0.0  # rad/s, positive left side up; 0 in a car that cannot roll

    def channels(self) -> Array:
        """Vector of all channels, (3w + 3,), in the order of `channel_layout`, then the vehicle's own."""
        return self._channels

    @cached_property
    def _channels(self) -> Array:
        vehicle = [self.pitch_rate, self.speed_m_s, self.roll_rate]
        return np.concatenate([self.body_acc, self.wheel_acc, self.rattle_m, vehicle])

    @classmethod
    def of_channels(cls, time_s: float, channels: Array) -> "Measurement":
        """Return the measurement with these channels."""
        measurement = cls.__new__(cls)
        pitch_rate, speed, roll_rate = channels[PITCH_RATE:].tolist()
        measurement.__dict__.update(  # the wheels' rows are taken when they are first read
            time_s=time_s,
            pitch_rate=pitch_rate,
            speed_m_s=speed,
            roll_rate=roll_rate,
            _channels=channels,
        )
        return measurement

    def __getattr__(self, name: str) -> Any:
        channels = self.__dict__.get("_channels")
        if channels is None or name not in _ROWS:
            raise AttributeError(f"{type(self).__name__} has no {name}")
        rows = getattr(channel_layout(len(channels) // 3 - 1), _ROWS[name])
        value = self.__dict__[name] = channels[rows]
        return value


_ROWS = {"body_acc": "body_acc", "wheel_acc": "wheel_acc", "rattle_m": "rattle"}
"""Field of `ChannelLayout` for each array of a measurement."""
_DRAWN = 100
"""Readings whose noise is drawn at once."""
PITCH_RATE, SPEED, ROLL_RATE = -3, -2, -1
"""Rows of the gyros and the speed in the vector of all channels, after those of the wheels."""


class ChannelLayout(NamedTuple):
    """Rows of the wheels' channels in the vector of all channels; acceleration: body and wheel together."""

    body_acc: slice
    wheel_acc: slice
    rattle: slice
    acceleration: slice


@lru_cache(maxsize=64)
def channel_layout(wheels: int) -> ChannelLayout:
    """Return the layout of the channels for this number of wheels."""
    body_acc, wheel_acc, rattle = (slice(i * wheels, (i + 1) * wheels) for i in range(3))
    return ChannelLayout(body_acc, wheel_acc, rattle, slice(0, 2 * wheels))


class Sensors:
    """Sensors of one car: offsets are drawn once, noise for each reading, both from `rng`, which is theirs.

    offset: of each channel, in the order of `Measurement.channels`.
    """

    def __init__(self, wheels: int, rng: np.random.Generator, noise: SensorNoise | None = None) -> None:
        self._rng, self._count = rng, 3 * wheels + 3
        self._roll_rng = rng.spawn(1)[0]  # independent of the other channels' draws
        noise_levels = self._noise = noise or SensorNoise()
        width = np.sqrt(noise_levels.bandwidth_hz)
        noises = np.repeat(
            [
                noise_levels.body_density_m_s2 * width,
                noise_levels.wheel_density_m_s2 * width,
                noise_levels.rattle_m,
            ],
            wheels,
        )
        offsets = np.repeat(
            [noise_levels.body_offset_m_s2, noise_levels.wheel_offset_m_s2, noise_levels.rattle_offset_m],
            wheels,
        )
        has_roll = wheels > 2
        gyros = (
            noise_levels.pitch_rate_density_rad_s * width,
            has_roll * noise_levels.roll_rate_density_rad_s * width,
        )
        self._sigma = np.array([*noises, gyros[0], noise_levels.speed_m_s, gyros[1]])
        offset_sigma = np.array(
            [
                *offsets,
                noise_levels.pitch_rate_offset_rad_s,
                0.0,
                has_roll * noise_levels.roll_rate_offset_rad_s,
            ]
        )
        self.offset = offset_sigma * self._normal(1)[0]
        self._scale = 1.0 + noise_levels.speed_scale * rng.standard_normal()
        resolution = noise_levels.interface
        sizes = np.repeat(
            [resolution.body_acc_step_m_s2, resolution.wheel_acc_step_m_s2, resolution.rattle_step_m], wheels
        )
        self._step = np.array(
            [
                *sizes,
                resolution.pitch_rate_step_rad_s,
                resolution.speed_step_m_s,
                resolution.roll_rate_step_rad_s,
            ]
        )
        self._delay_line: deque[Array] = deque(maxlen=resolution.delay_readings + 1)
        self._received: Array | None = None
        self._ideal_interface = resolution == SensorInterface()
        self._errors = self._error_rows()

    def measure(self, state: VehicleState) -> Measurement:
        """Return the reading for the present state."""
        reading = state.sensed()
        reading[SPEED] *= self._scale
        reading += next(self._errors)
        if not self._ideal_interface:
            reading = self._transmit(reading)
        return Measurement.of_channels(state.time_s, reading)

    def _error_rows(self) -> Iterator[Array]:
        """Offsets and noise of one reading after the other; drop-outs are drawn between those of two."""
        while True:
            yield from self.offset + self._sigma * self._normal(_DRAWN if self._ideal_interface else 1)

    def _normal(self, readings: int) -> Array:
        """Draw a standard normal number for each channel of each reading, (readings, channels)."""
        numbers = np.empty((readings, self._count))
        numbers[:, :-1] = self._rng.standard_normal((readings, self._count - 1))
        numbers[:, -1] = self._roll_rng.standard_normal(readings)
        return numbers

    def _transmit(self, reading: Array) -> Array:
        """Quantise, delay, and hold the last value of channels that drop out."""
        stepped = np.where(self._step > 0.0, self._step, 1.0)
        self._delay_line.append(np.where(self._step > 0.0, np.round(reading / stepped) * stepped, reading))
        arriving = self._delay_line[0]
        draws = np.append(self._rng.random(len(reading) - 1), self._roll_rng.random())
        lost = draws < self._noise.interface.dropout
        self._received = arriving if self._received is None else np.where(lost, self._received, arriving)
        return self._received
