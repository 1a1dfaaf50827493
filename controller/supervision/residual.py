"""Residual between measured and previewed road height of one wheel, with bounded errors of the preview.

A set-membership test: the preview with its tolerances bounds what may be measured (Milanese & Vicino,
Automatica 27(6), 1991); what lies outside is summed with forgetting, as in the CUSUM test (Page,
Biometrika 41, 1954).
"""

from enum import Enum
from typing import Any

import numpy as np

from foreride.controller.settings import GateSettings
from foreride.files.interpolation import FIRST, between, cell, interpolated
from foreride.files.jit import njit
from foreride.preview.road_preview import RoadPreview

FORGET_M = 0.1
"""Distance constant of the sums."""
PLAIN_M = 0.01
"""Height below which a preview announces nothing."""
LEVEL_M = 1.5
"""Distance constant of the high pass of both heights, as observers know no absolute height of the road."""
ROUGH_M = 10.0
"""Distance constant of the roughness, the mean absolute residual on plain road."""
SMOOTH_M = 0.002
"""Least roughness."""
LATE_M, LATE_SHARE = 2.0, 0.5
"""An obstacle not announced is one announced too late if one of this share of its height follows so soon."""
ROUGHS_PLAIN, ROUGHS_CLAIMED = 4.0, 2.5
"""Roughnesses that are tolerated, on plain road and at announced obstacles."""
_SAMPLES = np.linspace(-1.0, 1.0, 7)
_LEAST_SIZE_M = 0.02


class Strike(Enum):
    """Verdict on the road measured lately: as claimed, unannounced obstacle, or other than claimed."""

    CONSISTENT = "consistent"
    UNANNOUNCED = "unannounced"
    CONTRADICTED = "contradicted"


_STRIKES = tuple(Strike)
_CONSISTENT, _UNANNOUNCED, _CONTRADICTED = range(3)


class Residual:
    """Test of one wheel's preview; `feel` once a period.

    claimed_m, sigma_m: expected height and standard deviation of the position here, of the last preview.
    """

    claimed_m: float
    sigma_m: float

    def __init__(self, wheel: int, settings: GateSettings):
        self._wheel = wheel
        tolerances = settings.reach_m, settings.widest_m, settings.height_m, settings.gain
        self._tolerances = np.array([*tolerances, settings.least_gain, settings.strike_m])
        self._levels = np.full(2, np.nan)  # of felt and claimed heights; NaN before the first contact
        self._rough = np.array([SMOOTH_M])
        self._sums = np.zeros(3)  # unannounced, contradicted; whether what was unannounced comes late

    def feel(self, felt_m: float, contact: bool, preview: RoadPreview, travelled_m: float) -> Strike:
        """Add the road height measured now, `travelled_m` after the last one; ignored while in the air."""
        strike, self.claimed_m, self.sigma_m = _feel(
            felt_m,
            contact,
            travelled_m,
            self._wheel,
            preview.distance_m,
            preview.existence,
            preview.height_m,
            preview.position_sigma_m,
            preview.height_sigma_m,
            self._tolerances,
            self._levels,
            self._rough,
            self._sums,
        )
        return _STRIKES[strike]


@njit
def expected_at(value: float, grid: Any, existence: Any, height: Any) -> float:
    """Expected height at one distance: that of the grid, existence times height, interpolated."""
    last, j = len(grid) - 1, cell(grid, value, FIRST)
    if j < 0:
        return float(existence[0] * height[0])
    if j >= last:
        return float(existence[last] * height[last])
    low, high = existence[j] * height[j], existence[j + 1] * height[j + 1]
    return between(grid[j], grid[j + 1], low, high, value)


@njit
def claims(distances: Any, grid: Any, existence: Any, height: Any) -> tuple[float, float, float]:
    """Expected height at distance zero, and the lowest and the highest one at these distances."""
    low, high = np.inf, -np.inf
    for distance in distances:
        expected = expected_at(distance, grid, existence, height)
        low, high = min(low, expected), max(high, expected)
    return expected_at(0.0, grid, existence, height), low, high


@njit
def _feel(
    felt_m: float,
    contact: bool,
    travelled_m: float,
    wheel: int,
    grid: Any,
    existence: Any,
    height: Any,
    position_sigma: Any,
    height_sigma: Any,
    tolerances: Any,
    levels: Any,
    rough: Any,
    sums: Any,
) -> tuple[int, float, float]:
    """Index of the strike, then expected height and sigma of the position at distance zero.

    tolerances: of `GateSettings`. levels, rough, sums: see `Residual`; they change. A place is tolerated
    within its reach and sigma, and the widest.
    """
    reach_m, widest_m, tolerated_m, gain, least_gain, limit_m = tolerances
    sigma = interpolated(0.0, grid, position_sigma[wheel])
    reach = min(np.hypot(reach_m, sigma), widest_m)
    distances = np.empty(len(_SAMPLES))
    for i in range(len(distances)):
        distances[i] = reach * _SAMPLES[i]
    here, low, high = claims(distances, grid, existence[wheel], height[wheel])
    fade = np.exp(-travelled_m / FORGET_M)
    sums[0] *= fade
    sums[1] *= fade
    if contact:
        if np.isnan(levels[0]):
            levels[0], levels[1] = felt_m, here
        rise, low, high = felt_m - levels[0], low - levels[1], high - levels[1]
        size = max(-low, high)
        plain = size < PLAIN_M
        tolerated_m += (ROUGHS_PLAIN if plain else ROUGHS_CLAIMED) * rough[0]
        doubt = gain + 2.0 * interpolated(0.0, grid, height_sigma[wheel]) / max(size, _LEAST_SIZE_M)
        beyond = _beyond(rise, low, high, max(least_gain, 1.0 - doubt), 1.0 + doubt) - tolerated_m
        if plain:
            sums[0] += max(beyond, 0.0)
            sums[2] = _follows(rise, grid, existence[wheel], height[wheel])
            _learn_roughness(abs(here - levels[1] - rise), travelled_m, rough)
        else:
            sums[1] += max(beyond, 0.0)
        share = min(1.0, travelled_m / LEVEL_M)
        levels[0] += share * rise
        levels[1] += share * (here - levels[1])
    if sums[1] > limit_m:
        return _CONTRADICTED, here, sigma
    if sums[0] > limit_m:
        return _CONTRADICTED if sums[2] else _UNANNOUNCED, here, sigma
    return _CONSISTENT, here, sigma


@njit
def _beyond(rise: float, low: float, high: float, least: float, most: float) -> float:
    """How far a height is above or below the claimed ones, times the least or the greatest gain."""
    return max(rise - max(least * high, most * high), min(least * low, most * low) - rise)


@njit
def _follows(rise: float, grid: Any, existence: Any, height: Any) -> bool:
    """Whether an obstacle like the one measured is previewed close ahead."""
    greatest = 0.0
    for i in range(len(grid)):
        if 0.0 < grid[i] < LATE_M:
            expected = existence[i] * height[i]
            greatest = max(greatest, expected if rise > 0.0 else -expected)
    return rise != 0.0 and greatest > LATE_SHARE * abs(rise)


@njit
def _learn_roughness(error_m: float, travelled_m: float, rough: Any) -> None:
    """Update the roughness; an obstacle counts no more than twice the present value."""
    share = min(1.0, travelled_m / ROUGH_M)
    usual = min(max(error_m, SMOOTH_M), 2.0 * rough[0])
    rough[0] += share * (usual - rough[0])
