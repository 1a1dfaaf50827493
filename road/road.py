"""Road surface: features, roughness and measured heights on a vertical alignment."""

from dataclasses import dataclass
from functools import cached_property
from typing import Annotated

import numpy as np
from annotated_types import Interval
from numpy.typing import ArrayLike, NDArray

from foreride.files.errors import InputError
from foreride.files.reading.ranges import Checked
from foreride.road.features.feature import Feature, Step
from foreride.road.features.repeated import Chain
from foreride.road.io.reading_options import ReadingOptions
from foreride.road.io.surface_file import MeasuredSurface, read_surface
from foreride.road.roughness.iso8608 import Roughness, RoughSurface, rough_surface
from foreride.road.vertical_alignment import GradeChange, check_order, grade_at, grade_height

FADE_IN_M = 5.0
LONGEST_ROUGH_M = 32_768.0
"""Longest road with roughness, whose realisation takes about 12 kB per metre while it is made."""


@dataclass(frozen=True)
class Road(Checked):
    """Straight road of `length_m` from x = 0, its features in order of their near edge.

    Heights of overlapping features add up. Chains are expanded once: their copies join the features.
    Roughness and the heights in `file` (`road.io.formats`; `reading` says what differs from the conventions)
    rise smoothly from a plane over the first 5 m, so that a car is in equilibrium there: a level one or
    that of the file's first metres with its grade and bank. Behind the start the plane continues, beyond the
    end the roughness and the file's last grade. `file_sha256` pins the file's content; it is filled in when
    the file is read, so that a recorded road reveals when its file has changed. `grades` are changes of grade
    in their order along the road; all else is added to them.

    Raises InputError if a feature or a change of grade is not wholly inside [0, length_m], changes of grade
    overlap, or the file is bad or too short.
    """

    length_m: Annotated[float, Interval(ge=1e-3, le=100_000.0), "m"]
    features: tuple[Feature, ...] = ()
    roughness: Roughness | None = None
    chains: tuple[Chain, ...] = ()
    file: str | None = None
    file_sha256: str | None = None
    grades: tuple[GradeChange, ...] = ()
    reading: ReadingOptions | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.roughness is not None and self.length_m > LONGEST_ROUGH_M:
            raise InputError(
                f"length_m must be <= {LONGEST_ROUGH_M:g} m with roughness, got {self.length_m:g}"
            )
        chained = tuple(feature for chain in self.chains for feature in chain.features())
        names = [f"features[{index}]" for index in range(len(self.features))] + ["chains"] * len(chained)
        for name, feature in zip(names, self.features + chained, strict=True):
            if feature.start_m < 0 or feature.end_m > self.length_m:
                raise InputError(
                    f"{name} ({feature.kind}) spans {feature.start_m:g} to {feature.end_m:g} m "
                    f"and must lie inside the road, 0 to length_m = {self.length_m:g} m"
                )
        check_order(self.grades, self.length_m)
        ordered = tuple(sorted(self.features + chained, key=lambda feature: feature.start_m))
        object.__setattr__(self, "features", ordered)
        object.__setattr__(self, "chains", ())
        if self._measured is not None:
            self._check_file(self._measured)

    def height(self, x: ArrayLike, y: ArrayLike) -> NDArray[np.float64]:
        """Height of the road (m) at world points, broadcast over x and y."""
        x, y = np.asarray(x, float), np.asarray(y, float)
        z = np.zeros(np.broadcast_shapes(x.shape, y.shape))
        if self.grades:
            z += grade_height(self.grades, x)
        fade = np.clip(x / FADE_IN_M, 0.0, 1.0)
        fade = fade * fade * (3 - 2 * fade)
        if self._surface is not None:
            z += fade * self._surface.height(x, y)
        if self._measured is not None:
            plane = self._measured.start_plane(x, y)
            z += plane + fade * (self._measured.continued_height(x, y) - plane)
        x, y = np.broadcast_arrays(x, y)
        for feature in self.features:
            within = (x >= feature.start_m) & (y >= feature.y_min_m) & (y <= feature.y_max_m)
            if not isinstance(feature, Step):
                within &= x <= feature.end_m
            if within.any():
                z[within] += feature.height(x[within], y[within])
        return z

    def grade(self, x: float) -> float:
        """Grade (m/m) of the road's plane at x: that of `grades` and of the file, without roughness."""
        own = 0.0 if self._measured is None else self._measured.grade(x)
        return own + grade_at(self.grades, x)

    def _check_file(self, measured: MeasuredSurface) -> None:
        if measured.length_m < self.length_m:
            raise InputError(
                f"length_m must be <= {measured.length_m:g} m (end of {self.file}), got {self.length_m:g}"
            )
        if self.file_sha256 not in (None, measured.sha256):
            raise InputError(f"file_sha256 differs from that of {self.file}: the file has changed")
        object.__setattr__(self, "file_sha256", measured.sha256)

    @property
    def is_flat_between_features(self) -> bool:
        """True if the height is zero wherever no feature spans x."""
        steps = any(isinstance(feature, Step) for feature in self.features)
        return self.roughness is None and self.file is None and not steps and not self.grades

    @cached_property
    def _surface(self) -> RoughSurface | None:
        return None if self.roughness is None else rough_surface(self.roughness, self.length_m)

    @property
    def measured(self) -> MeasuredSurface | None:
        """The surface read from `file`."""
        return self._measured

    @cached_property
    def _measured(self) -> MeasuredSurface | None:
        return None if self.file is None else read_surface(self.file, self.reading)
