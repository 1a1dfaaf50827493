"""Road preview: height over distance ahead of each wheel, with uncertainty, as a controller receives it."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from math import inf
from typing import Any, Protocol

import numpy as np

from foreride.files.errors import InputError
from foreride.files.interpolation import at, interpolated
from foreride.files.jit import njit

_DOUBLE, _STRIDE, _HERE = np.dtype(float), (8,), np.zeros(1)
_WRONG, _UNCERTAIN, _EXACT = range(3)
_FIELDS = "time_s", "distance_m", "height_m", "position_sigma_m", "height_sigma_m", "existence"

PREVIEW_M = 10.0
"""Length of the road ahead that controllers of dampers are given."""


class Profile(Protocol):
    """Effective road height (m) as a function of position x (m), for example a `WheelProfile`."""

    def height(self, x: np.ndarray) -> np.ndarray:
        """Height (m) at x (m)."""
        ...


@dataclass(frozen=True)
class RoadPreview:
    """Road ahead of each wheel, on one uniform grid of distances.

    time_s: moment at which the grid is anchored to the wheels.
    distance_m: (n,) ascending and uniform, ahead of each wheel's contact centre; below zero is behind.
    height_m: (wheels, n) effective (tyre-enveloped) road height over the local road plane.
    position_sigma_m: (wheels, n) standard deviation along the road of the features that make this height.
    height_sigma_m: (wheels, n) standard deviation of the height itself.
    existence: (wheels, n) probability 0..1 that the feature is real; 0 where nothing was seen.
    age_s: age of the newest measurement inside.
    Wrong shapes or values raise `InputError`.
    """

    time_s: float
    distance_m: np.ndarray
    height_m: np.ndarray
    position_sigma_m: np.ndarray
    height_sigma_m: np.ndarray
    existence: np.ndarray
    age_s: float = 0.0

    def __post_init__(self) -> None:
        if not self._is_accepted():
            self._check()

    def _is_accepted(self) -> bool:
        """Whether all arrays are as they must be already; `is_exact` and `height_here_m` are known then."""
        grid, height, existence = self.distance_m, self.height_m, self.existence
        position, sigma = self.position_sigma_m, self.height_sigma_m
        if not type(grid) is type(height) is type(position) is type(sigma) is type(existence) is np.ndarray:
            return False
        if not grid.dtype == height.dtype == position.dtype == sigma.dtype == existence.dtype == _DOUBLE:
            return False
        n, shape, strides = grid.size, height.shape, height.strides
        if n < 2 or grid.shape != (n,) or grid.strides != _STRIDE or len(shape) != 2 or shape[1] != n:
            return False
        if not shape == position.shape == sigma.shape == existence.shape or strides != (8 * n, 8):
            return False
        if not strides == position.strides == sigma.strides == existence.strides or shape[0] == 0:
            return False
        here = np.empty(shape[0])
        verdict = _examined(grid, height, position, sigma, existence, here)
        if verdict == _WRONG:
            return False
        self.__dict__.update(is_exact=verdict == _EXACT, height_here_m=here)
        return True

    def _check(self) -> None:
        """Convert all arrays; raise InputError for the first that is wrong."""
        distance = np.asarray(self.distance_m, dtype=float)
        if distance.ndim != 1 or len(distance) < 2:
            raise InputError(f"distance_m must have shape (n,) with n >= 2, got {distance.shape}")
        steps = distance[1:] - distance[:-1]
        if not (steps[0] > 0 and np.abs(steps - steps[0]).max() <= 1e-9 + 1e-5 * steps[0]):
            raise InputError("distance_m must ascend in equal steps, got unequal or descending steps")
        object.__setattr__(self, "distance_m", distance)
        wheels = np.asarray(self.height_m).shape[0] if np.ndim(self.height_m) == 2 else 0
        for name in ("height_m", "position_sigma_m", "height_sigma_m", "existence"):
            values = np.asarray(getattr(self, name), dtype=float)
            if wheels == 0 or values.shape != (wheels, len(distance)):
                raise InputError(f"{name} must have shape (wheels, {len(distance)}), got {values.shape}")
            low, high = values.min(), values.max()
            if not -inf < low <= high < inf:
                raise InputError(f"{name} must be finite, got NaN or infinity")
            if low < 0.0 and name in ("position_sigma_m", "height_sigma_m"):
                raise InputError("position_sigma_m and height_sigma_m must be >= 0, got a negative value")
            object.__setattr__(self, name, values)
        if low < 0 or high > 1:  # of existence, the last one
            raise InputError(
                f"existence must lie in 0..1, got {self.existence.min()}..{self.existence.max()}"
            )

    @classmethod
    def unchecked(
        cls, time_s: float, *arrays: np.ndarray, age_s: float = 0.0, **properties: bool | np.ndarray
    ) -> "RoadPreview":
        """Preview whose arrays, in the order of the fields, are known to be as they must be.

        properties: `is_exact`, `is_certain`, `is_empty` and `height_here_m` where they are known.
        """
        preview = object.__new__(cls)
        preview.__dict__.update(zip(_FIELDS, (time_s, *arrays), strict=True), age_s=age_s, **properties)
        return preview

    @classmethod
    def exact(
        cls, time_s: float, distance_m: np.ndarray, height_m: np.ndarray, height_here_m: np.ndarray
    ) -> "RoadPreview":
        """Error-free preview of heights that are known to be as they must be, here (wheels,) as well."""
        arrays = distance_m, height_m, *_error_free(height_m.shape)
        return cls.unchecked(time_s, *arrays, is_exact=True, is_certain=True, height_here_m=height_here_m)

    @property
    def wheels(self) -> int:
        """Number of wheels."""
        return self.height_m.shape[0]

    @cached_property
    def is_exact(self) -> bool:
        """Whether the preview claims to be free of errors."""
        return not (self.position_sigma_m.any() or self.height_sigma_m.any())

    @cached_property
    def is_empty(self) -> bool:
        """Whether nothing was seen: a level road of existence 0."""
        return not (self.existence.any() or self.height_m.any())

    @cached_property
    def is_certain(self) -> bool:
        """Whether the preview claims to be free of errors, with everything in it real."""
        return self.is_exact and bool((self.existence == 1.0).all())

    @cached_property
    def height_here_m(self) -> np.ndarray:
        """Height at distance zero of each wheel, (wheels,) m; not to be changed."""
        return at(_HERE, self.distance_m, self.height_m)[:, 0]

    def height(self, wheel: int, distance: float | np.ndarray) -> np.ndarray:
        """Height (m) at `distance` ahead of `wheel`: linear between grid points, constant beyond."""
        return np.interp(distance, self.distance_m, self.height_m[wheel])

    def advanced(self, distance: float, time_s: float) -> "RoadPreview":
        """The same road anchored `distance` metres farther on, at `time_s`; the age grows accordingly."""
        shifted_distance = self.distance_m + distance

        def shifted(rows: np.ndarray) -> np.ndarray:
            return np.stack([np.interp(shifted_distance, self.distance_m, row) for row in rows])

        return replace(
            self,
            time_s=time_s,
            height_m=shifted(self.height_m),
            position_sigma_m=shifted(self.position_sigma_m),
            height_sigma_m=shifted(self.height_sigma_m),
            existence=shifted(self.existence),
            age_s=self.age_s + time_s - self.time_s,
        )


@njit
def _examined(
    distance: Any, height: Any, position_sigma: Any, height_sigma: Any, existence: Any, here: Any
) -> int:
    """Verdict on a preview, whose heights at distance zero are written into `here` (wheels,).

    Distances must ascend in equal steps, heights be finite, sigmas >= 0 and existences in 0 ... 1.
    """
    first = distance[1] - distance[0]
    wheels, n = height.shape
    wrong = 0 if first > 0.0 else 1  # counted without branches, which lets the compiler take several at once
    uncertain = 0
    for i in range(1, n - 1):
        wrong += not abs(distance[i + 1] - distance[i] - first) <= 1e-9 + 1e-5 * first
    for wheel in range(wheels):
        for i in range(n):
            wrong += not abs(height[wheel, i]) < inf
            wrong += not (existence[wheel, i] >= 0.0) & (existence[wheel, i] <= 1.0)
            wrong += not (position_sigma[wheel, i] >= 0.0) & (position_sigma[wheel, i] < inf)
            wrong += not (height_sigma[wheel, i] >= 0.0) & (height_sigma[wheel, i] < inf)
            uncertain += (position_sigma[wheel, i] > 0.0) | (height_sigma[wheel, i] > 0.0)
        here[wheel] = interpolated(0.0, distance, height[wheel])
    return _WRONG if wrong else _UNCERTAIN if uncertain else _EXACT


def within(preview: RoadPreview, ahead_m: float) -> RoadPreview:
    """The part of a preview up to a distance ahead."""
    count = int(np.searchsorted(preview.distance_m, ahead_m + 1e-9))
    if count >= len(preview.distance_m):
        return preview
    return replace(
        preview,
        distance_m=preview.distance_m[:count],
        height_m=preview.height_m[:, :count].copy(),
        position_sigma_m=preview.position_sigma_m[:, :count].copy(),
        height_sigma_m=preview.height_sigma_m[:, :count].copy(),
        existence=preview.existence[:, :count].copy(),
    )


@lru_cache(maxsize=8)
def distance_grid(behind_m: float = 0.5, ahead_m: float = PREVIEW_M, step_m: float = 0.025) -> np.ndarray:
    """Distances of a preview grid, from `-behind_m` to `ahead_m`, both included; read-only."""
    grid = np.arange(-round(behind_m / step_m), round(ahead_m / step_m) + 1) * step_m
    grid.setflags(write=False)
    return grid


def flat_preview(wheels: int, time_s: float = 0.0, distance_m: np.ndarray | None = None) -> RoadPreview:
    """Preview without any information: flat, existence 0."""
    distance = distance_grid() if distance_m is None else distance_m
    nothing = np.zeros((wheels, len(distance)))
    return RoadPreview(time_s, distance, nothing, nothing, nothing, nothing)


def oracle_preview(
    profiles: Sequence[Profile],
    wheel_x_m: Sequence[float] | np.ndarray,
    time_s: float = 0.0,
    distance_m: np.ndarray | None = None,
) -> RoadPreview:
    """Preview of the true effective profile: sigmas 0, existence 1.

    profiles: one per wheel, world heights under the tyre.
    wheel_x_m: world position of each wheel's contact centre at `time_s`.
    """
    if len(profiles) != len(wheel_x_m):
        raise InputError(f"profiles must be one per wheel ({len(wheel_x_m)}), got {len(profiles)}")
    distance = distance_grid() if distance_m is None else distance_m
    height = np.array([profile.height(x + distance) for profile, x in zip(profiles, wheel_x_m, strict=True)])
    return RoadPreview(time_s, distance, height, *_error_free(height.shape))


@lru_cache(maxsize=8)
def constant_rows(shape: tuple[int, int], value: float) -> np.ndarray:
    """Rows (wheels, n) of one value, read-only."""
    rows = np.full(shape, value)
    rows.setflags(write=False)
    return rows


def _error_free(shape: tuple[int, int]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Standard deviations of position and height, and existence, of a preview without errors."""
    zeros = constant_rows(shape, 0.0)
    return zeros, zeros, constant_rows(shape, 1.0)
