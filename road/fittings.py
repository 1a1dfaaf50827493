"""Expansion joints, manhole covers and steps: obstacles that are neither speed bump nor pothole."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from files.errors import InputError
from road.bumps import MAX_POSITION_M
from road.checks import check_number


@dataclass(frozen=True)
class ExpansionJoint:
    """Expansion joint: a gap across the road with vertical walls, as between the slabs of a bridge.

    Args:
        start_m: x of the near edge.
        gap_m: width of the gap along x.
        depth_m: depth of its floor (the seal) under the road.
        lip_m: height of the steel edges, each `lip_length_m` long, before and behind the gap; 0 for none.
        y_min_m, y_max_m: lateral extent.
    """

    kind: ClassVar[str] = "expansion_joint"
    cls: ClassVar[None] = None
    start_m: float
    gap_m: float = 0.06
    depth_m: float = 0.03
    lip_m: float = 0.0
    lip_length_m: float = 0.08
    y_min_m: float = -3.5
    y_max_m: float = 3.5

    def __post_init__(self) -> None:
        check_number("start_m", self.start_m, -MAX_POSITION_M, MAX_POSITION_M)
        check_number("gap_m", self.gap_m, 0.0, 1.0, open_low=True)
        check_number("depth_m", self.depth_m, 0.0, 0.3, open_low=True)
        check_number("lip_m", self.lip_m, 0.0, 0.05)
        check_number("lip_length_m", self.lip_length_m, 0.0, 0.5)
        _check_extent(self.y_min_m, self.y_max_m)

    @property
    def length_m(self) -> float:
        return self.gap_m + 2 * self._edge_m

    @property
    def end_m(self) -> float:
        return self.start_m + self.length_m

    @property
    def _edge_m(self) -> float:
        return self.lip_length_m if self.lip_m > 0 else 0.0

    def height(self, x: ArrayLike, y: ArrayLike) -> NDArray[np.float64]:
        """Height over the road (m) at world points, broadcast over x and y."""
        s = np.asarray(x, float) - self.start_m
        edge = self._edge_m
        profile = np.where((s > edge) & (s < self.length_m - edge), -self.depth_m, self.lip_m)
        return np.where(self.footprint(x, y), profile, 0.0)

    def footprint(self, x: ArrayLike, y: ArrayLike) -> NDArray[np.bool_]:
        """True where the feature covers the road, broadcast over x and y."""
        s, y = np.asarray(x, float) - self.start_m, np.asarray(y, float)
        return (s > 0) & (s < self.length_m) & (y >= self.y_min_m) & (y <= self.y_max_m)


@dataclass(frozen=True)
class ManholeCover:
    """Manhole cover: a round plate raised or sunk by `height_m` (negative: sunk) with an edge `edge_m` wide.

    start_m is the near end of its diameter, which lies along y = y_m.
    """

    kind: ClassVar[str] = "manhole_cover"
    cls: ClassVar[None] = None
    start_m: float
    height_m: float = -0.02
    diameter_m: float = 0.7
    y_m: float = 0.0
    edge_m: float = 0.03

    def __post_init__(self) -> None:
        check_number("start_m", self.start_m, -MAX_POSITION_M, MAX_POSITION_M)
        check_number("height_m", self.height_m, -0.2, 0.2)
        check_number("diameter_m", self.diameter_m, 0.0, 3.0, open_low=True)
        check_number("y_m", self.y_m, -50.0, 50.0)
        check_number("edge_m", self.edge_m, 0.0, self.diameter_m / 2, open_low=True)

    @property
    def length_m(self) -> float:
        return self.diameter_m

    @property
    def end_m(self) -> float:
        return self.start_m + self.diameter_m

    @property
    def y_min_m(self) -> float:
        return self.y_m - self.diameter_m / 2

    @property
    def y_max_m(self) -> float:
        return self.y_m + self.diameter_m / 2

    def height(self, x: ArrayLike, y: ArrayLike) -> NDArray[np.float64]:
        """Height over the road (m) at world points, broadcast over x and y."""
        return self.height_m * np.clip((self.diameter_m / 2 - self.distance(x, y)) / self.edge_m, 0.0, 1.0)

    def footprint(self, x: ArrayLike, y: ArrayLike) -> NDArray[np.bool_]:
        """True where the feature covers the road, broadcast over x and y."""
        return self.distance(x, y) <= self.diameter_m / 2

    def distance(self, x: ArrayLike, y: ArrayLike) -> NDArray[np.float64]:
        """Horizontal distance (m) from the centre, broadcast over x and y."""
        centre = self.start_m + self.diameter_m / 2
        return np.hypot(np.asarray(x, float) - centre, np.asarray(y, float) - self.y_m)


@dataclass(frozen=True)
class Step:
    """Step: a change of level by `height_m` (negative: down) over `ramp_m` up to the end of the road.

    Two of opposite height make a resurfaced or milled stretch. `footprint` and `end_m` are those of the edge.
    """

    kind: ClassVar[str] = "step"
    cls: ClassVar[None] = None
    start_m: float
    height_m: float
    ramp_m: float = 0.02
    y_min_m: float = -3.5
    y_max_m: float = 3.5

    def __post_init__(self) -> None:
        check_number("start_m", self.start_m, -MAX_POSITION_M, MAX_POSITION_M)
        check_number("height_m", self.height_m, -0.3, 0.3)
        if self.height_m == 0:
            raise InputError("height_m must differ from 0, got 0")
        check_number("ramp_m", self.ramp_m, 0.0, 5.0, open_low=True)
        _check_extent(self.y_min_m, self.y_max_m)

    @property
    def length_m(self) -> float:
        return self.ramp_m

    @property
    def end_m(self) -> float:
        return self.start_m + self.ramp_m

    def height(self, x: ArrayLike, y: ArrayLike) -> NDArray[np.float64]:
        """Height over the road (m) at world points, broadcast over x and y."""
        x, y = np.asarray(x, float), np.asarray(y, float)
        rise = self.height_m * np.clip((x - self.start_m) / self.ramp_m, 0.0, 1.0)
        return rise * ((y >= self.y_min_m) & (y <= self.y_max_m))

    def footprint(self, x: ArrayLike, y: ArrayLike) -> NDArray[np.bool_]:
        """True on the ramp between the two levels, broadcast over x and y."""
        x, y = np.asarray(x, float), np.asarray(y, float)
        return (x >= self.start_m) & (x <= self.end_m) & (y >= self.y_min_m) & (y <= self.y_max_m)


Fitting = ExpansionJoint | ManholeCover | Step


def _check_extent(y_min_m: float, y_max_m: float) -> None:
    check_number("y_min_m", y_min_m, -50.0, 50.0)
    check_number("y_max_m", y_max_m, y_min_m, 50.0, open_low=True)
