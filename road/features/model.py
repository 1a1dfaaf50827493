"""Road feature: base class of all discrete obstacles."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from foreride.files.reading.ranges import Checked


@dataclass(frozen=True)
class RoadFeature(Checked):
    """Base of the features: frozen dataclasses that carry their name as `kind`.

    A feature adds its `height(x, y)` to the road: positive for bumps and humps, negative for potholes, zero
    outside its `footprint(x, y)` (except a step, which persists). The field `start_m` is the near edge, the
    first x at which the height departs from zero, `end_m` the far edge; y_min_m ... y_max_m is the lateral
    extent. `cls` is the detector class: 0 speed bump, 1 pothole, None for all others.
    """

    kind: ClassVar[str]
    cls: ClassVar[int | None] = None

    if TYPE_CHECKING:  # fields or properties of the subclasses

        @property
        def start_m(self) -> float:
            """Position of the near edge, m."""

        @property
        def end_m(self) -> float:
            """Position of the far edge, m."""

        @property
        def y_min_m(self) -> float:
            """Right end, m."""

        @property
        def y_max_m(self) -> float:
            """Left end, m."""

    def height(self, x: ArrayLike, y: ArrayLike) -> NDArray[np.float64]:
        """Height over the road (m) at world points, broadcast over x and y."""
        raise NotImplementedError

    def footprint(self, x: ArrayLike, y: ArrayLike) -> NDArray[np.bool_]:
        """True where the feature covers the road, broadcast over x and y; by default its rectangle."""
        x, y = np.asarray(x, float), np.asarray(y, float)
        return (x >= self.start_m) & (x <= self.end_m) & (y >= self.y_min_m) & (y <= self.y_max_m)

    @property
    def crest_m(self) -> float:
        """Height of the crest, or of a pothole's floor as a negative number, m.

        By default that on the middle line.
        """
        x = np.linspace(self.start_m, self.end_m, 401)
        heights = self.height(x, (self.y_min_m + self.y_max_m) / 2)
        return float(heights[np.argmax(np.abs(heights))])

    def painted(
        self, albedo: NDArray[np.float32], x: NDArray, y: NDArray, rng: np.random.Generator
    ) -> NDArray[np.float32]:
        """Albedo (n, m, 3) of the feature on a road of `albedo`, at x (n, 1), y (1, m).

        By default that of the road: the feature is seen by light and shade alone.
        """
        return albedo
