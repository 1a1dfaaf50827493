"""Bumps, humps and cushions: raised features with a profile along x and lateral tapers."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from foreride.files.errors import InputError
from foreride.files.reading.checks import check_choice, check_number
from foreride.road.features.model import RoadFeature
from foreride.road.features.quantities import Height, Lateral, Length, Position, Ramp, Taper

PAINTS = (
    "plain",
    "yellow_black",
    "white_stripes",
    "white_triangles",
    "zebra",
    "red",
    "bare",
    "rubber",
    "slanted",
    "white_yellow",
    "zigzag",
)


class _RaisedFeature(RoadFeature):
    """Base class of raised features; a subclass gives its normalised profile along x as `_unit_profile`.

    The normalised profile is 1 at the crest and 0 at both ends.
    """

    start_m: float
    height_m: float
    length_m: float
    y_min_m: float
    y_max_m: float
    taper_m: float
    paint: str

    def __post_init__(self) -> None:
        super().__post_init__()
        check_choice("paint", self.paint, PAINTS)
        self._check()

    def _check(self) -> None:
        check_number("y_max_m", self.y_max_m, self.y_min_m, 50.0, open_low=True)
        check_number("taper_m", self.taper_m, 0.0, (self.y_max_m - self.y_min_m) / 2)

    @property
    def end_m(self) -> float:
        """Position of the far edge, m."""
        return self.start_m + self.length_m

    @property
    def crest_m(self) -> float:
        """Height of the crest, m."""
        return float(self.height_m)

    def height(self, x: ArrayLike, y: ArrayLike) -> NDArray[np.float64]:
        """Height over the road (m) at world points, broadcast over x and y."""
        s = np.clip(np.asarray(x, float) - self.start_m, 0.0, self.length_m)
        return self.height_m * self._unit_profile(s) * self._lateral_taper(y)

    def _unit_profile(self, s: NDArray[np.float64]) -> NDArray[np.float64]:
        """Profile normalised by `height_m` at distances s, 0 to length_m, from the near edge."""
        raise NotImplementedError

    def _lateral_taper(self, y: ArrayLike) -> NDArray[np.float64]:
        """Lateral taper factor: 1 over the bump's width, a smooth step to 0 over taper_m at both ends."""
        y = np.asarray(y, float)
        margin = np.minimum(y - self.y_min_m, self.y_max_m - y)
        if self.taper_m == 0:
            return (margin >= 0).astype(float)
        t = np.clip(margin / self.taper_m, 0.0, 1.0)
        return t * t * (3 - 2 * t)


@dataclass(frozen=True)
class HalfSineBump(_RaisedFeature):
    """Bump with a half-sine profile along x.

    Args:
        start_m: x of the near edge.
        height_m: crest over the road.
        length_m: extent along x.
        y_min_m, y_max_m: lateral extent; inside it both ends run out over `taper_m`.
        paint: surface marking, one of PAINTS; no effect on the height.
    """

    kind: ClassVar[str] = "half_sine_bump"
    cls: ClassVar[int] = 0
    start_m: Position
    height_m: Height
    length_m: Length
    y_min_m: Lateral = -3.5
    y_max_m: Lateral = 3.5
    taper_m: Taper = 0.1
    paint: str = "plain"

    def _unit_profile(self, s: NDArray[np.float64]) -> NDArray[np.float64]:
        nearer_end = np.minimum(s, self.length_m - s)  # exactly zero at both ends, as sin(pi) is not
        return np.sin(np.pi * nearer_end / self.length_m)


@dataclass(frozen=True)
class SinusoidalHump(_RaisedFeature):
    """Hump with a raised-cosine profile along x (one period), tangent to the road at both ends.

    Arguments as for HalfSineBump.
    """

    kind: ClassVar[str] = "sinusoidal_hump"
    cls: ClassVar[int] = 0
    start_m: Position
    height_m: Height = 0.1
    length_m: Length = 3.8
    y_min_m: Lateral = -3.5
    y_max_m: Lateral = 3.5
    taper_m: Taper = 0.2
    paint: str = "plain"

    def _unit_profile(self, s: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.sin(np.pi * np.minimum(s, self.length_m - s) / self.length_m) ** 2


@dataclass(frozen=True)
class WattsHump(_RaisedFeature):
    """Watts hump: circular-arc profile over the chord `length_m` (Watts, TRRL LR 597, 1973).

    Arguments as for HalfSineBump.
    """

    kind: ClassVar[str] = "watts_hump"
    cls: ClassVar[int] = 0
    start_m: Position
    height_m: Height = 0.09
    length_m: Length = 3.6
    y_min_m: Lateral = -3.5
    y_max_m: Lateral = 3.5
    taper_m: Taper = 0.2
    paint: str = "plain"

    def _check(self) -> None:
        super()._check()
        if self.height_m > self.length_m / 2:
            raise InputError(f"height_m must be <= length_m / 2 (a half circle), got {self.height_m!r}")

    def _unit_profile(self, s: NDArray[np.float64]) -> NDArray[np.float64]:
        half, h = self.length_m / 2, self.height_m
        radius = (half**2 + h**2) / (2 * h)
        arc = np.sqrt(radius**2 - (s - half) ** 2) - (radius - h)
        return np.maximum(arc, 0.0) / h


@dataclass(frozen=True)
class FlatTopHump(_RaisedFeature):
    """Flat-top hump (speed table): linear ramps of `ramp_m` at both ends and a flat top.

    `length_m` includes both ramps; other arguments as for HalfSineBump.
    """

    kind: ClassVar[str] = "flat_top_hump"
    cls: ClassVar[int] = 0
    start_m: Position
    height_m: Height = 0.09
    length_m: Length = 3.6
    ramp_m: Ramp = 0.6
    y_min_m: Lateral = -3.5
    y_max_m: Lateral = 3.5
    taper_m: Taper = 0.2
    paint: str = "plain"

    def _check(self) -> None:
        super()._check()
        check_number("ramp_m", self.ramp_m, 0.0, self.length_m / 2, open_low=True)

    def _unit_profile(self, s: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.minimum(np.minimum(s, self.length_m - s) / self.ramp_m, 1.0)


@dataclass(frozen=True)
class TrapezoidalBump(_RaisedFeature):
    """Bolt-on bump with a trapezoidal profile: linear ramps up and down, which may differ, and a flat top.

    `length_m` includes both ramps; other arguments as for HalfSineBump.
    """

    kind: ClassVar[str] = "trapezoidal_bump"
    cls: ClassVar[int] = 0
    start_m: Position
    height_m: Height = 0.05
    length_m: Length = 0.6
    ramp_up_m: Ramp = 0.2
    ramp_down_m: Ramp = 0.2
    y_min_m: Lateral = -3.5
    y_max_m: Lateral = 3.5
    taper_m: Taper = 0.1
    paint: str = "plain"

    def _check(self) -> None:
        super()._check()
        check_number("ramp_up_m", self.ramp_up_m, 0.0, self.length_m, open_low=True)
        check_number("ramp_down_m", self.ramp_down_m, 0.0, self.length_m - self.ramp_up_m, open_low=True)

    def _unit_profile(self, s: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.minimum(np.minimum(s / self.ramp_up_m, (self.length_m - s) / self.ramp_down_m), 1.0)


@dataclass(frozen=True)
class SpeedCushion(_RaisedFeature):
    """Speed cushion: a truncated pyramid narrower than a car's track, which wide vehicles straddle.

    Ramps are linear, `ramp_m` long at both ends and `taper_m` at both sides (by default 1:8 and 1:4), inside
    length_m and y_min_m ... y_max_m; other arguments as for HalfSineBump.
    """

    kind: ClassVar[str] = "speed_cushion"
    cls: ClassVar[int] = 0
    start_m: Position
    height_m: Height = 0.065
    length_m: Length = 3.0
    ramp_m: Ramp = 0.52
    y_min_m: Lateral = -0.7
    y_max_m: Lateral = 0.7
    taper_m: Taper = 0.26
    paint: str = "plain"

    def _check(self) -> None:
        super()._check()
        check_number("ramp_m", self.ramp_m, 0.0, self.length_m / 2, open_low=True)
        check_number("taper_m", self.taper_m, 0.0, (self.y_max_m - self.y_min_m) / 2, open_low=True)

    def height(self, x: ArrayLike, y: ArrayLike) -> NDArray[np.float64]:
        """Height over the road (m) at world points, broadcast over x and y."""
        s, y = np.clip(np.asarray(x, float) - self.start_m, 0.0, self.length_m), np.asarray(y, float)
        along = np.minimum(s, self.length_m - s) / self.ramp_m
        across = np.minimum(y - self.y_min_m, self.y_max_m - y) / self.taper_m
        return self.height_m * np.clip(np.minimum(along, across), 0.0, 1.0)


Bump = HalfSineBump | SinusoidalHump | WattsHump | FlatTopHump | TrapezoidalBump | SpeedCushion
