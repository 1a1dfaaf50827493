"""The road: features and roughness on a plane."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from files.errors import InputError
from road.checks import check_number
from road.features import Feature
from road.roughness import Roughness, RoughSurface, rough_surface

FADE_IN_M = 5.0


@dataclass(frozen=True)
class Road:
    """A straight road of `length_m` from x = 0, its features in order of their near edge.

    Heights of overlapping features add up. Roughness rises smoothly from nothing at x = 0 over the first
    FADE_IN_M, so that a car at rest there is in equilibrium; behind the start the road is flat, beyond the
    end the roughness goes on.

    Raises InputError if a feature is not wholly inside [0, length_m].
    """

    length_m: float
    features: tuple[Feature, ...] = ()
    roughness: Roughness | None = None

    def __post_init__(self) -> None:
        check_number("length_m", self.length_m, 0.0, 100_000.0, open_low=True)
        for index, feature in enumerate(self.features):
            if feature.start_m < 0 or feature.end_m > self.length_m:
                raise InputError(
                    f"features[{index}] ({feature.kind}) spans {feature.start_m:g} to {feature.end_m:g} m "
                    f"and must lie inside the road, 0 to length_m = {self.length_m:g} m"
                )
        ordered = tuple(sorted(self.features, key=lambda feature: feature.start_m))
        object.__setattr__(self, "features", ordered)

    def height(self, x: ArrayLike, y: ArrayLike) -> NDArray[np.float64]:
        """Height of the road (m) at world points, broadcast over x and y."""
        x, y = np.asarray(x, float), np.asarray(y, float)
        z = np.zeros(np.broadcast_shapes(x.shape, y.shape))
        if self._surface is not None:
            fade = np.clip(x / FADE_IN_M, 0.0, 1.0)
            z += fade * fade * (3 - 2 * fade) * self._surface.height(x, y)
        x, y = np.broadcast_arrays(x, y)
        for feature in self.features:
            near = (x >= feature.start_m) & (x <= feature.end_m)
            near &= (y >= feature.y_min_m) & (y <= feature.y_max_m)
            if near.any():
                z[near] += feature.height(x[near], y[near])
        return z

    @cached_property
    def _surface(self) -> RoughSurface | None:
        return None if self.roughness is None else rough_surface(self.roughness, self.length_m)
