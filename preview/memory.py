"""What a drive leaves for the next one: how the camera sits, what the detector's rows mean, what lies where.

A file of it (YAML) belongs to one car on one road; without its objects it serves on any. Positions are
those of the odometer, so both drives must start at the same place; what the odometer drifts meanwhile widens
what is remembered.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import yaml

from files import strict
from files.atomic import write_text
from files.errors import InputError
from preview.calibration import MOUNTING, ROWS, Calibration
from preview.fit import HEIGHT, LENGTH, Direct, X, fit, start_state
from preview.settings import Settings
from preview.shape import KINDS
from preview.track import Edge, Track

_KINDS = {kind.name: kind for kind in KINDS}


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
class Rows:
    """How far down the detector draws bottom edges, of bumps and of potholes (px), with their covariance.

    with_pitch (rad px), with_height (m px): covariance of each with the errors of the mounting.
    """

    bottom_px: tuple[float, float]
    variance: tuple[float, float]
    covariance: float
    with_pitch: tuple[float, float]
    with_height: tuple[float, float]


@dataclass(frozen=True)
class Remembered:
    """One object: what, where and how large (m), how sure; each sigma is that of the value before it."""

    kind: str
    x_m: float
    x_sigma_m: float
    length_m: float
    length_sigma_m: float
    height_m: float
    height_sigma_m: float
    y_min_m: float
    y_max_m: float
    y_sigma_m: float
    existence: float

    def __post_init__(self) -> None:
        if self.kind not in _KINDS:
            raise InputError(f"kind must be one of {', '.join(_KINDS)}, got {self.kind!r}")
        for name in ("x_sigma_m", "length_m", "length_sigma_m", "height_m", "height_sigma_m", "y_sigma_m"):
            if not getattr(self, name) > 0:
                raise InputError(f"{name} must be > 0, got {getattr(self, name)!r}")
        if not 0 < self.existence < 1:
            raise InputError(f"existence must lie within 0 ... 1, got {self.existence!r}")
        if not self.y_min_m <= self.y_max_m:
            raise InputError(f"y_min_m must be <= y_max_m ({self.y_max_m!r}), got {self.y_min_m!r}")


@dataclass(frozen=True)
class Memory:
    """Mounting and rows as learned, and the objects met, in the order in which they were passed.

    rows: None in files from before they were learned.
    """

    mounting: Mounting
    objects: tuple[Remembered, ...] = ()
    rows: Rows | None = None

    def __post_init__(self) -> None:
        covariance = _covariance(self.mounting, self.rows) if self.rows else np.eye(4)
        scale = np.sqrt(np.diag(covariance).clip(1e-30))
        if np.linalg.eigvalsh(covariance / np.outer(scale, scale)).min() < -1e-6:
            raise InputError(f"rows.variance must be >= 0 and bound the covariances, got {self.rows!r}")


def read(path: Path | str) -> Memory:
    """A memory from its file. Raises InputError naming the file and the field."""
    memory = strict.read(Memory, path)
    assert isinstance(memory, Memory)
    return memory


def write(path: Path, memory: Memory) -> None:
    """Write a memory in one step."""
    write_text(path, yaml.safe_dump(strict.to_mapping(memory), sort_keys=False))


def remember(calibration: Calibration, tracks: list[Track]) -> Memory:
    """What is worth keeping of a drive: the calibration and all confirmed `tracks`."""
    (pitch, cross, *with_pitch), (_, height, *with_height) = calibration.covariance[MOUNTING].tolist()
    (bump, both), (_, hole) = calibration.covariance[ROWS, ROWS].tolist()
    offset, lift, *rows = calibration.mean.tolist()
    return Memory(
        Mounting(offset, lift, pitch, cross, height),
        tuple(_remembered(track) for track in tracks if track.confirmed),
        Rows(tuple(rows), (bump, hole), both, tuple(with_pitch), tuple(with_height)),
    )


def recall(calibration: Calibration, memory: Memory) -> None:
    """Start from mounting and rows as they were learned."""
    kept = memory.mounting
    calibration.mean[MOUNTING] = kept.pitch_rad, kept.height_m
    if memory.rows is None:
        calibration.covariance[MOUNTING, MOUNTING] = _of_mounting(kept)
    else:
        calibration.mean[ROWS] = memory.rows.bottom_px
        calibration.covariance = _covariance(kept, memory.rows)


def expectations(
    memory: Memory, calibration: Calibration, settings: Settings, x_m: float, first: int = 0
) -> list[Track]:
    """Tracks that await the remembered objects, numbered from `first`; the odometer starts at `x_m`."""
    return [
        _expected(number, place, calibration, settings, x_m)
        for number, place in enumerate(memory.objects, first)
    ]


def _of_mounting(kept: Mounting) -> np.ndarray:
    return np.array([[kept.pitch_variance, kept.covariance], [kept.covariance, kept.height_variance]])


def _covariance(mounting: Mounting, rows: Rows) -> np.ndarray:
    """Covariance (4, 4) of the states of `preview.calibration`."""
    across = np.array([rows.with_pitch, rows.with_height])
    (bump, hole), both = rows.variance, rows.covariance
    return np.block([[_of_mounting(mounting), across], [across.T, np.array([[bump, both], [both, hole]])]])


def _remembered(track: Track) -> Remembered:
    best = track.best
    sigma = np.sqrt(np.diag(best.covariance))
    return Remembered(
        best.kind.name,
        float(best.state[X]),
        float(sigma[X]),
        float(best.state[LENGTH]),
        float(sigma[LENGTH]),
        float(best.state[HEIGHT]),
        float(sigma[HEIGHT]),
        track.right.y_m,
        max(track.right.y_m, track.left.y_m),
        float(np.sqrt(max(track.right.variance, track.left.variance))),
        track.existence,
    )


def _expected(
    identity: int, place: Remembered, calibration: Calibration, settings: Settings, x_m: float
) -> Track:
    kind = _KINDS[place.kind]
    # Both drives' odometers have drifted by the time the object comes.
    drift = np.sqrt(2.0) * settings.odometry_sigma * abs(place.x_m - x_m)
    directs = [
        Direct(X, place.x_m, float(np.hypot(place.x_sigma_m, drift))),
        Direct(LENGTH, place.length_m, place.length_sigma_m),
        Direct(HEIGHT, place.height_m, place.height_sigma_m),
    ]
    prior = calibration.prior(kind.cls)
    start = start_state(place.x_m, prior, place.length_m, place.height_m)
    best = fit(kind, [], start, prior, directs, settings)
    variance = place.y_sigma_m**2
    track = Track(
        identity,
        kind.cls,
        0.0,
        float(np.log(place.existence / (1 - place.existence))),
        Edge(place.y_min_m, variance),
        Edge(place.y_max_m, variance),
        [best],
        directs=directs,
        hits=0,
    )
    track.last_seen_x_m = place.x_m
    track.confirmed = track.existence > settings.confirm_existence
    return track
