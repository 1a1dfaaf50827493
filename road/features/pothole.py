"""Pothole with an irregular rim."""

from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np
from annotated_types import Interval
from numpy.typing import ArrayLike, NDArray

from foreride.files.reading.checks import check_number
from foreride.files.reading.ranges import Seed
from foreride.road.features.model import RoadFeature
from foreride.road.features.pothole_rim import Rim, irregular_rim
from foreride.road.features.quantities import Height, Lateral, Length, Position, Ramp


@dataclass(frozen=True)
class Pothole(RoadFeature):
    """Pothole with an irregular rim, walls of slope depth_m / wall_m, and a flat floor.

    Args:
        start_m: x of the near edge.
        depth_m: depth of the floor under the road.
        length_m: extent along x; exact on the line y = y_m, nowhere exceeded.
        width_m: extent along y.
        y_m: lateral position of the centre.
        wall_m: horizontal run of the wall from the rim down to the floor.
        irregularity: relative amplitude of the rim's deviation from an ellipse (0 is the ellipse).
        seed: seed of the rim's shape.
    """

    kind: ClassVar[str] = "pothole"
    cls: ClassVar[int] = 1
    start_m: Position
    depth_m: Height
    length_m: Length
    width_m: Length
    y_m: Lateral = 0.0
    wall_m: Ramp = 0.05
    irregularity: Annotated[float, Interval(ge=0.0, le=0.5), "1"] = 0.2
    seed: Seed = 0

    def __post_init__(self) -> None:
        super().__post_init__()
        check_number("wall_m", self.wall_m, 0.0, min(self.length_m, self.width_m) / 2, open_low=True)

    @property
    def end_m(self) -> float:
        """Position of the far edge, m."""
        return self.start_m + self.length_m

    @property
    def crest_m(self) -> float:
        """Height of the floor, m."""
        return -self.depth_m

    @property
    def y_min_m(self) -> float:
        """Position of the right edge, m."""
        return self.y_m - self.width_m / 2

    @property
    def y_max_m(self) -> float:
        """Position of the left edge, m."""
        return self.y_m + self.width_m / 2

    def height(self, x: ArrayLike, y: ArrayLike) -> NDArray[np.float64]:
        """Height over the road (m, <= 0) at world points, broadcast over x and y."""
        return -self.depth_m * np.clip(self._inward_distance(x, y) / self.wall_m, 0.0, 1.0)

    def footprint(self, x: ArrayLike, y: ArrayLike) -> NDArray[np.bool_]:
        """True inside the rim, broadcast over x and y."""
        return self._inward_distance(x, y) > 0

    def _inward_distance(self, x: ArrayLike, y: ArrayLike) -> NDArray[np.float64]:
        """Distance (m) from the rim inwards along the ray to the centre; negative outside."""
        dx = np.asarray(x, float) - (self.start_m + self.length_m / 2)
        dy = np.asarray(y, float) - self.y_m
        return self._rim.inward_distance(dx, dy, self.length_m / 2, self.width_m / 2)

    @property
    def _rim(self) -> Rim:
        return irregular_rim(self.irregularity, self.seed)
