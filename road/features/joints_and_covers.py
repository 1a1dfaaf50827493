"""Expansion joints, manhole covers and steps: obstacles that are neither speed bump nor pothole."""

from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np
from annotated_types import Interval
from numpy.typing import ArrayLike, NDArray

from foreride.files.errors import InputError
from foreride.files.reading.checks import check_number
from foreride.road.features.model import RoadFeature
from foreride.road.features.quantities import Lateral, Position, Ramp


@dataclass(frozen=True)
class ExpansionJoint(RoadFeature):
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
    start_m: Position
    gap_m: Annotated[float, Interval(ge=1e-3, le=1.0), "m"] = 0.06
    depth_m: Annotated[float, Interval(ge=1e-4, le=0.3), "m"] = 0.03
    lip_m: Annotated[float, Interval(ge=0.0, le=0.05), "m"] = 0.0
    lip_length_m: Annotated[float, Interval(ge=0.0, le=0.5), "m"] = 0.08
    y_min_m: Lateral = -3.5
    y_max_m: Lateral = 3.5

    def __post_init__(self) -> None:
        super().__post_init__()
        _check_extent(self.y_min_m, self.y_max_m)

    @property
    def length_m(self) -> float:
        """Length along the road, m."""
        return self.gap_m + 2 * self._edge_m

    @property
    def end_m(self) -> float:
        """Position of the far edge, m."""
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
class ManholeCover(RoadFeature):
    """Manhole cover: a round plate raised or sunk by `height_m` (negative: sunk) with an edge `edge_m` wide.

    start_m is the near end of its diameter, which lies along y = y_m.
    """

    kind: ClassVar[str] = "manhole_cover"
    cls: ClassVar[None] = None
    start_m: Position
    height_m: Annotated[float, Interval(ge=-0.2, le=0.2), "m"] = -0.02
    diameter_m: Annotated[float, Interval(ge=1e-2, le=3.0), "m"] = 0.7
    y_m: Lateral = 0.0
    edge_m: Ramp = 0.03

    def __post_init__(self) -> None:
        super().__post_init__()
        check_number("edge_m", self.edge_m, 0.0, self.diameter_m / 2, open_low=True)

    @property
    def length_m(self) -> float:
        """Length along the road, m."""
        return self.diameter_m

    @property
    def end_m(self) -> float:
        """Position of the far edge, m."""
        return self.start_m + self.diameter_m

    @property
    def y_min_m(self) -> float:
        """Position of the right edge, m."""
        return self.y_m - self.diameter_m / 2

    @property
    def y_max_m(self) -> float:
        """Position of the left edge, m."""
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
class Step(RoadFeature):
    """Step: a change of level by `height_m` (negative: down) over `ramp_m` up to the end of the road.

    Two of opposite height make a resurfaced or milled stretch. `footprint` and `end_m` are those of the edge.
    """

    kind: ClassVar[str] = "step"
    cls: ClassVar[None] = None
    start_m: Position
    height_m: Annotated[float, Interval(ge=-0.3, le=0.3), "m"]
    ramp_m: Annotated[float, Interval(ge=1e-3, le=5.0), "m"] = 0.02
    y_min_m: Lateral = -3.5
    y_max_m: Lateral = 3.5

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.height_m == 0:
            raise InputError("height_m must differ from 0, got 0")
        _check_extent(self.y_min_m, self.y_max_m)

    @property
    def length_m(self) -> float:
        """Length along the road, m."""
        return self.ramp_m

    @property
    def end_m(self) -> float:
        """Position of the far edge, m."""
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
    check_number("y_max_m", y_max_m, y_min_m, 50.0, open_low=True)
