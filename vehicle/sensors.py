"""What the car's own sensors report: the truth with noise and offsets, from a seeded generator.

Default values, each for a class of part rather than a part:

* body accelerometer and gyro: automotive six-axis MEMS module (±8 g, ±125 °/s); noise densities of 60 µg/√Hz
  and 5 m°/s/√Hz; what standstill calibration leaves of the offsets, 3 mg and 0.05 °/s
* wheel accelerometer: automotive high-g MEMS (±120 g); 1 mg/√Hz, offset 50 mg
* rattle: Hall-effect level sensor on a linkage, ±100 mm; 0.2 mm noise, 1 mm of zero error
* speed: toothed-ring wheel-speed sensor; 0.02 m/s noise, 0.3 % error of the rolling radius
"""

from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from files.errors import InputError
from vehicle.parameters import GRAVITY_M_S2
from vehicle.state import VehicleState

Array = NDArray[np.float64]


@dataclass(frozen=True)
class SensorNoise:
    """Standard deviations of noise (per sample, inside each sensor's bandwidth) and of offsets (per car)."""

    body_density_m_s2: float = 60e-6 * GRAVITY_M_S2  # per √Hz
    body_offset_m_s2: float = 3e-3 * GRAVITY_M_S2
    wheel_density_m_s2: float = 1e-3 * GRAVITY_M_S2  # per √Hz
    wheel_offset_m_s2: float = 50e-3 * GRAVITY_M_S2
    pitch_rate_density_rad_s: float = float(np.radians(5e-3))  # per √Hz
    pitch_rate_offset_rad_s: float = float(np.radians(0.05))
    rattle_m: float = 2e-4
    rattle_offset_m: float = 1e-3
    speed_m_s: float = 0.02
    speed_scale: float = 0.003  # relative
    bandwidth_hz: float = 200.0  # of accelerometers and gyro

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if not (np.isfinite(value) and value >= 0.0):
                raise InputError(f"{field.name} must be >= 0 and finite, got {value}")


NO_NOISE = SensorNoise(**{field.name: 0.0 for field in fields(SensorNoise)})


@dataclass(frozen=True, eq=False)
class Measurement:
    """One reading of all sensors; accelerations are zero at standstill; w wheels, front first."""

    time_s: float
    body_acc: Array  # (w,) above each wheel, m/s²
    wheel_acc: Array  # (w,) m/s²
    rattle_m: Array  # (w,) body minus wheel
    pitch_rate: float  # rad/s, positive nose-down
    speed_m_s: float


class Sensors:
    """The sensors of one car: offsets are drawn once, noise anew at each reading, both from `rng`."""

    def __init__(self, wheels: int, rng: np.random.Generator, noise: SensorNoise | None = None) -> None:
        self._rng, self._wheels = rng, wheels
        n = self._noise = noise or SensorNoise()
        width = np.sqrt(n.bandwidth_hz)
        noises = np.repeat([n.body_density_m_s2 * width, n.wheel_density_m_s2 * width, n.rattle_m], wheels)
        offsets = np.repeat([n.body_offset_m_s2, n.wheel_offset_m_s2, n.rattle_offset_m], wheels)
        self._sigma = np.array([*noises, n.pitch_rate_density_rad_s * width, n.speed_m_s])
        self._offset = np.array([*offsets, n.pitch_rate_offset_rad_s, 0.0]) * rng.standard_normal(
            offsets.size + 2
        )
        self._scale = 1.0 + n.speed_scale * rng.standard_normal()

    def measure(self, state: VehicleState) -> Measurement:
        """The reading at one moment."""
        w = self._wheels
        error = self._offset + self._sigma * self._rng.standard_normal(3 * w + 2)
        return Measurement(
            time_s=state.time_s,
            body_acc=state.body_acc + error[:w],
            wheel_acc=state.wheel_acc + error[w : 2 * w],
            rattle_m=state.rattle_m + error[2 * w : 3 * w],
            pitch_rate=float(state.pitch_rate + error[-2]),
            speed_m_s=float(state.speed_m_s * self._scale + error[-1]),
        )
