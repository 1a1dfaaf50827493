"""Speed bumps, speed humps and potholes: the discrete obstacles of a road.

A feature adds its `height(x, y)` to the road: positive for bumps and humps, negative for potholes, zero
outside its `footprint(x, y)`. `start_m` is the near edge, the first x at which the height departs from zero.
"""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from files.errors import InputError
from road.checks import check_choice, check_integer, check_number
from road.rim import Rim, irregular_rim

PAINTS = ("plain", "yellow_black", "white_stripes", "white_triangles", "zebra", "red")
MAX_POSITION_M = 1e6


@dataclass(frozen=True)
class HalfSineBump:
    """Bump whose profile along x is half a period of a sine.

    Args:
        start_m: x of the near edge.
        height_m: crest over the road.
        length_m: extent along x.
        y_min_m, y_max_m: lateral extent; inside it both ends run out over `taper_m`.
        paint: look of its surface, one of PAINTS; no effect on the height.
    """

    kind: ClassVar[str] = "half_sine_bump"
    cls: ClassVar[int] = 0
    start_m: float
    height_m: float
    length_m: float
    y_min_m: float = -3.5
    y_max_m: float = 3.5
    taper_m: float = 0.1
    paint: str = "plain"

    def __post_init__(self) -> None:
        _check_bump(self)

    @property
    def end_m(self) -> float:
        return self.start_m + self.length_m

    def height(self, x: ArrayLike, y: ArrayLike) -> NDArray[np.float64]:
        """Height over the road (m) at world points, broadcast over x and y."""
        s = _inside(self, x)
        nearer_end = np.minimum(s, self.length_m - s)  # exactly zero at both ends, as sin(pi) is not
        return self.height_m * np.sin(np.pi * nearer_end / self.length_m) * _end_taper(self, y)

    def footprint(self, x: ArrayLike, y: ArrayLike) -> NDArray[np.bool_]:
        """True where the feature covers the road, broadcast over x and y."""
        return _rectangle(self, x, y)


@dataclass(frozen=True)
class WattsHump:
    """Hump whose profile along x is a circular arc over the chord `length_m` (Watts, TRRL LR 597, 1973).

    Arguments as for HalfSineBump.
    """

    kind: ClassVar[str] = "watts_hump"
    cls: ClassVar[int] = 0
    start_m: float
    height_m: float = 0.09
    length_m: float = 3.6
    y_min_m: float = -3.5
    y_max_m: float = 3.5
    taper_m: float = 0.2
    paint: str = "plain"

    def __post_init__(self) -> None:
        _check_bump(self)
        if self.height_m > self.length_m / 2:
            raise InputError(f"height_m must be <= length_m / 2 (a half circle), got {self.height_m!r}")

    @property
    def end_m(self) -> float:
        return self.start_m + self.length_m

    def height(self, x: ArrayLike, y: ArrayLike) -> NDArray[np.float64]:
        """Height over the road (m) at world points, broadcast over x and y."""
        half, h = self.length_m / 2, self.height_m
        radius = (half**2 + h**2) / (2 * h)
        arc = np.sqrt(radius**2 - (_inside(self, x) - half) ** 2) - (radius - h)
        return np.maximum(arc, 0.0) * _end_taper(self, y)

    def footprint(self, x: ArrayLike, y: ArrayLike) -> NDArray[np.bool_]:
        """True where the feature covers the road, broadcast over x and y."""
        return _rectangle(self, x, y)


@dataclass(frozen=True)
class FlatTopHump:
    """Hump with linear ramps of `ramp_m` at both ends and a flat top between them (a speed table).

    `length_m` includes both ramps; other arguments as for HalfSineBump.
    """

    kind: ClassVar[str] = "flat_top_hump"
    cls: ClassVar[int] = 0
    start_m: float
    height_m: float = 0.09
    length_m: float = 3.6
    ramp_m: float = 0.6
    y_min_m: float = -3.5
    y_max_m: float = 3.5
    taper_m: float = 0.2
    paint: str = "plain"

    def __post_init__(self) -> None:
        _check_bump(self)
        check_number("ramp_m", self.ramp_m, 0.0, self.length_m / 2, open_low=True)

    @property
    def end_m(self) -> float:
        return self.start_m + self.length_m

    def height(self, x: ArrayLike, y: ArrayLike) -> NDArray[np.float64]:
        """Height over the road (m) at world points, broadcast over x and y."""
        s = _inside(self, x)
        rise = np.minimum(np.minimum(s, self.length_m - s) / self.ramp_m, 1.0)
        return self.height_m * rise * _end_taper(self, y)

    def footprint(self, x: ArrayLike, y: ArrayLike) -> NDArray[np.bool_]:
        """True where the feature covers the road, broadcast over x and y."""
        return _rectangle(self, x, y)


@dataclass(frozen=True)
class Pothole:
    """Hole with an irregular rim, walls that slope linearly over `wall_m`, and a flat floor.

    Args:
        start_m: x of the near edge.
        depth_m: depth of the floor under the road.
        length_m: extent along x; exact on the line y = y_m, nowhere exceeded.
        width_m: extent along y.
        y_m: lateral position of the centre.
        wall_m: horizontal run of the wall from the rim down to the floor.
        irregularity: relative amplitude of the rim about an ellipse (0 is the ellipse).
        seed: of the rim's shape.
    """

    kind: ClassVar[str] = "pothole"
    cls: ClassVar[int] = 1
    start_m: float
    depth_m: float
    length_m: float
    width_m: float
    y_m: float = 0.0
    wall_m: float = 0.05
    irregularity: float = 0.2
    seed: int = 0

    def __post_init__(self) -> None:
        check_number("start_m", self.start_m, -MAX_POSITION_M, MAX_POSITION_M)
        check_number("depth_m", self.depth_m, 0.0, 0.5, open_low=True)
        check_number("length_m", self.length_m, 0.0, 20.0, open_low=True)
        check_number("width_m", self.width_m, 0.0, 20.0, open_low=True)
        check_number("y_m", self.y_m, -50.0, 50.0)
        check_number("wall_m", self.wall_m, 0.0, min(self.length_m, self.width_m) / 2, open_low=True)
        check_number("irregularity", self.irregularity, 0.0, 0.5)
        check_integer("seed", self.seed, 0)

    @property
    def end_m(self) -> float:
        return self.start_m + self.length_m

    @property
    def y_min_m(self) -> float:
        return self.y_m - self.width_m / 2

    @property
    def y_max_m(self) -> float:
        return self.y_m + self.width_m / 2

    def height(self, x: ArrayLike, y: ArrayLike) -> NDArray[np.float64]:
        """Height over the road (m, <= 0) at world points, broadcast over x and y."""
        return -self.depth_m * np.clip(self._depth_into(x, y) / self.wall_m, 0.0, 1.0)

    def footprint(self, x: ArrayLike, y: ArrayLike) -> NDArray[np.bool_]:
        """True inside the rim, broadcast over x and y."""
        return self._depth_into(x, y) > 0

    def _depth_into(self, x: ArrayLike, y: ArrayLike) -> NDArray[np.float64]:
        """Distance (m) from the rim inwards along the ray to the centre; negative outside."""
        dx = np.asarray(x, float) - (self.start_m + self.length_m / 2)
        dy = np.asarray(y, float) - self.y_m
        return self._rim.inward_distance(dx, dy, self.length_m / 2, self.width_m / 2)

    @property
    def _rim(self) -> Rim:
        return irregular_rim(self.irregularity, self.seed)


Feature = HalfSineBump | WattsHump | FlatTopHump | Pothole
FEATURE_KINDS: dict[str, type[Feature]] = {f.kind: f for f in (HalfSineBump, WattsHump, FlatTopHump, Pothole)}


Bump = HalfSineBump | WattsHump | FlatTopHump


def _check_bump(bump: Bump) -> None:
    check_number("start_m", bump.start_m, -MAX_POSITION_M, MAX_POSITION_M)
    check_number("height_m", bump.height_m, 0.0, 0.5, open_low=True)
    check_number("length_m", bump.length_m, 0.0, 20.0, open_low=True)
    check_number("y_min_m", bump.y_min_m, -50.0, 50.0)
    check_number("y_max_m", bump.y_max_m, bump.y_min_m, 50.0, open_low=True)
    check_number("taper_m", bump.taper_m, 0.0, (bump.y_max_m - bump.y_min_m) / 2)
    check_choice("paint", bump.paint, PAINTS)


def _inside(bump: Bump, x: ArrayLike) -> NDArray[np.float64]:
    """Distance from the near edge, clipped to the bump, where every profile is zero at both ends."""
    return np.clip(np.asarray(x, float) - bump.start_m, 0.0, bump.length_m)


def _end_taper(bump: Bump, y: ArrayLike) -> NDArray[np.float64]:
    """Factor 1 over the bump's width, falling to 0 at its lateral ends as a smooth step over taper_m."""
    y = np.asarray(y, float)
    margin = np.minimum(y - bump.y_min_m, bump.y_max_m - y)
    if bump.taper_m == 0:
        return (margin >= 0).astype(float)
    t = np.clip(margin / bump.taper_m, 0.0, 1.0)
    return t * t * (3 - 2 * t)


def _rectangle(bump: Bump, x: ArrayLike, y: ArrayLike) -> NDArray[np.bool_]:
    x, y = np.asarray(x, float), np.asarray(y, float)
    return (x >= bump.start_m) & (x <= bump.end_m) & (y >= bump.y_min_m) & (y <= bump.y_max_m)
