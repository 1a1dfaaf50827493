"""Drive memory: camera mounting errors, detector edge bias and objects, kept for the next drive (YAML).

A file of it belongs to one car on one road; without its objects it is valid on any. Positions are those of
the odometer, so both drives must start at the same place; odometer drift widens the remembered positions.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import numpy as np
import yaml
from annotated_types import Interval

from foreride.detector.calibration import Bias
from foreride.files.errors import InputError, shown
from foreride.files.reading import strict
from foreride.files.reading.ranges import Checked
from foreride.files.writing.atomic import write_text
from foreride.preview.obstacle_classes import KINDS

RowVariance = Annotated[float, Interval(ge=1e-12, le=1e6), "px²"]
WithMounting = Annotated[float, Interval(ge=-1e4, le=1e4), "rad·px or m·px"]
Sigma = Annotated[float, Interval(ge=1e-9, le=1e5), "m"]
TEMPLATE_BY_NAME = {kind.name: kind for kind in KINDS}


@dataclass(frozen=True)
class Mounting(Checked):
    """Errors of the camera's nominal mounting with their covariance: pitch (rad), height (m)."""

    pitch_rad: Annotated[float, Interval(ge=-0.6, le=0.6), "rad"] = 0.0
    height_m: Annotated[float, Interval(ge=-4.0, le=4.0), "m"] = 0.0
    pitch_variance: Annotated[float, Interval(ge=0.0, le=1.0), "rad²"] = 0.0
    covariance: Annotated[float, Interval(ge=-10.0, le=10.0), "rad·m"] = 0.0
    height_variance: Annotated[float, Interval(ge=0.0, le=100.0), "m²"] = 0.0

    def __post_init__(self) -> None:
        super().__post_init__()
        variances = self.pitch_variance, self.height_variance
        if self.covariance**2 > variances[0] * variances[1] * (1 + 1e-9):
            raise InputError(
                "pitch_variance and height_variance must bound the covariance, got "
                f"{variances[0]:g}, {variances[1]:g} and {self.covariance:g}"
            )


@dataclass(frozen=True)
class RowBias(Checked):
    """Bottom-edge bias of the detector, of bumps and of potholes (px, positive downwards), with covariance.

    with_pitch (rad px), with_height (m px): covariance of each with the errors of the mounting.
    """

    bottom_px: tuple[Bias, Bias]
    variance: tuple[RowVariance, RowVariance]
    covariance: Annotated[float, Interval(ge=-1e6, le=1e6), "px²"]
    with_pitch: tuple[WithMounting, WithMounting]
    with_height: tuple[WithMounting, WithMounting]


@dataclass(frozen=True)
class RememberedObject(Checked):
    """Object kept from a drive: kind, position, size (m), existence; a sigma is that of the value before it.

    Length and height are the measured ones, without the prior of the object's kind; None if not measured.
    """

    kind: str
    x_m: Annotated[float, Interval(ge=-1e6, le=1e6), "m"]
    x_sigma_m: Sigma
    length_m: Annotated[float, Interval(ge=1e-6, le=100.0), "m"] | None
    length_sigma_m: Sigma | None
    height_m: Annotated[float, Interval(ge=1e-6, le=10.0), "m"] | None
    height_sigma_m: Sigma | None
    y_min_m: Annotated[float, Interval(ge=-100.0, le=100.0), "m"]
    y_max_m: Annotated[float, Interval(ge=-100.0, le=100.0), "m"]
    y_sigma_m: Sigma
    existence: Annotated[float, Interval(gt=0.0, lt=1.0), "1"]

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.kind not in TEMPLATE_BY_NAME:
            raise InputError(f"kind must be one of {', '.join(TEMPLATE_BY_NAME)}, got {shown(self.kind)}")
        for name in ("length", "height"):
            if (getattr(self, f"{name}_m") is None) != (getattr(self, f"{name}_sigma_m") is None):
                raise InputError(f"{name}_m and {name}_sigma_m must both be null or both be numbers")
        if not self.y_min_m <= self.y_max_m:
            raise InputError(f"y_min_m must be <= y_max_m ({self.y_max_m!r}), got {self.y_min_m!r}")


@dataclass(frozen=True)
class Memory:
    """Result of a drive: mounting and edge bias as learned, and the objects in the order of passing.

    rows: None in files of older versions without edge bias.
    """

    mounting: Mounting
    objects: tuple[RememberedObject, ...] = ()
    rows: RowBias | None = None

    def __post_init__(self) -> None:
        if self.rows is None:
            return
        covariance = calibration_covariance(self.mounting, self.rows)
        scale = np.sqrt(np.diag(covariance).clip(1e-30))
        if np.linalg.eigvalsh(covariance / np.outer(scale, scale)).min() < -1e-6:
            raise InputError(f"rows.variance must bound the covariances, got {shown(self.rows)}")


def read(path: Path | str) -> Memory:
    """Memory from its file. Raises InputError naming the file and the field."""
    memory = strict.read(Memory, path)
    assert isinstance(memory, Memory)
    return memory


def write(path: Path, memory: Memory) -> None:
    """Write a memory atomically."""
    write_text(path, to_text(memory))


def to_text(memory: Memory) -> str:
    """Text of a memory file (YAML)."""
    return str(yaml.safe_dump(strict.to_mapping(memory), sort_keys=False))


def mounting_covariance(mounting: Mounting) -> np.ndarray:
    """Covariance (2, 2) of pitch and height."""
    return np.array(
        [[mounting.pitch_variance, mounting.covariance], [mounting.covariance, mounting.height_variance]]
    )


def calibration_covariance(mounting: Mounting, rows: RowBias) -> np.ndarray:
    """Covariance (4, 4) of the states of `preview.tracking.mounting_filter`."""
    cross = np.array([rows.with_pitch, rows.with_height])
    (bump, hole), covariance = rows.variance, rows.covariance
    return np.block(
        [
            [mounting_covariance(mounting), cross],
            [cross.T, np.array([[bump, covariance], [covariance, hole]])],
        ]
    )
