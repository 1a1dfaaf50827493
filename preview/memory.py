"""Drive memory: camera mounting errors, detector edge bias and objects, kept for the next drive (YAML).

A file of it belongs to one car on one road; without its objects it is valid on any. Positions are those of
the odometer, so both drives must start at the same place; odometer drift widens the remembered positions.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import yaml

from files import strict
from files.atomic import write_text
from files.errors import InputError
from preview.shape import KINDS

KIND_OF = {kind.name: kind for kind in KINDS}


@dataclass(frozen=True)
class Mounting:
    """Errors of the camera's nominal mounting with their covariance: pitch (rad), height (m)."""

    pitch_rad: float = 0.0
    height_m: float = 0.0
    pitch_variance: float = 0.0
    covariance: float = 0.0
    height_variance: float = 0.0

    def __post_init__(self) -> None:
        variances = self.pitch_variance, self.height_variance
        if min(variances) < 0 or self.covariance**2 > variances[0] * variances[1] * (1 + 1e-9):
            raise InputError(
                "pitch_variance and height_variance must be >= 0 and bound the covariance, got "
                f"{variances[0]:g}, {variances[1]:g} and {self.covariance:g}"
            )


@dataclass(frozen=True)
class RowBias:
    """Bottom-edge bias of the detector, of bumps and of potholes (px, positive downwards), with covariance.

    with_pitch (rad px), with_height (m px): covariance of each with the errors of the mounting.
    """

    bottom_px: tuple[float, float]
    variance: tuple[float, float]
    covariance: float
    with_pitch: tuple[float, float]
    with_height: tuple[float, float]

    def __post_init__(self) -> None:
        if not min(self.variance) > 0:
            raise InputError(f"variance must be > 0, got {list(self.variance)}")


@dataclass(frozen=True)
class Remembered:
    """Remembered object: kind, position and size (m), existence; each sigma is that of the value before it.

    Length and height are the measured ones, without the prior of the object's kind; None if not measured.
    """

    kind: str
    x_m: float
    x_sigma_m: float
    length_m: float | None
    length_sigma_m: float | None
    height_m: float | None
    height_sigma_m: float | None
    y_min_m: float
    y_max_m: float
    y_sigma_m: float
    existence: float

    def __post_init__(self) -> None:
        if self.kind not in KIND_OF:
            raise InputError(f"kind must be one of {', '.join(KIND_OF)}, got {self.kind!r}")
        for name in ("x_sigma_m", "length_m", "length_sigma_m", "height_m", "height_sigma_m", "y_sigma_m"):
            value = getattr(self, name)
            if value is not None and not value > 0:
                raise InputError(f"{name} must be > 0, got {value!r}")
        for name in ("length", "height"):
            if (getattr(self, f"{name}_m") is None) != (getattr(self, f"{name}_sigma_m") is None):
                raise InputError(f"{name}_m and {name}_sigma_m must both be null or both be numbers")
        if not 0 < self.existence < 1:
            raise InputError(f"existence must be > 0 and < 1, got {self.existence!r}")
        if not self.y_min_m <= self.y_max_m:
            raise InputError(f"y_min_m must be <= y_max_m ({self.y_max_m!r}), got {self.y_min_m!r}")


@dataclass(frozen=True)
class Memory:
    """Result of a drive: mounting and edge bias as learned, and the objects in the order of passing.

    rows: None in files of older versions without edge bias.
    """

    mounting: Mounting
    objects: tuple[Remembered, ...] = ()
    rows: RowBias | None = None

    def __post_init__(self) -> None:
        if self.rows is None:
            return
        covariance = covariance_of(self.mounting, self.rows)
        scale = np.sqrt(np.diag(covariance).clip(1e-30))
        if np.linalg.eigvalsh(covariance / np.outer(scale, scale)).min() < -1e-6:
            raise InputError(f"rows.variance must bound the covariances, got {self.rows!r}")


def read(path: Path | str) -> Memory:
    """Memory from its file. Raises InputError naming the file and the field."""
    memory = strict.read(Memory, path)
    assert isinstance(memory, Memory)
    return memory


def write(path: Path, memory: Memory) -> None:
    """Write a memory atomically."""
    write_text(path, yaml.safe_dump(strict.to_mapping(memory), sort_keys=False))


def of_mounting(kept: Mounting) -> np.ndarray:
    """Covariance (2, 2) of pitch and height."""
    return np.array([[kept.pitch_variance, kept.covariance], [kept.covariance, kept.height_variance]])


def covariance_of(mounting: Mounting, rows: RowBias) -> np.ndarray:
    """Covariance (4, 4) of the states of `preview.calibration`."""
    across = np.array([rows.with_pitch, rows.with_height])
    (bump, hole), both = rows.variance, rows.covariance
    return np.block([[of_mounting(mounting), across], [across.T, np.array([[bump, both], [both, hole]])]])
