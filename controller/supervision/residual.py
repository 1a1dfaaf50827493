"""Residual between measured and previewed road height of one wheel, with bounded errors of the preview.

A set-membership test: the preview with its tolerances bounds what may be measured (Milanese & Vicino,
Automatica 27(6), 1991); what lies outside is summed with forgetting, as in the CUSUM test (Page,
Biometrika 41, 1954).
"""

from enum import Enum
from math import exp
from typing import Any, NamedTuple

import numpy as np

from foreride.controller.settings import GateSettings
from foreride.files.interpolation import between, cell, interpolated
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


class Claim(NamedTuple):
    """Claim of a preview about one wheel, m: expected height here, with its lowest and highest nearby.

    sigma, height_sigma: standard deviations of position and height here. up, down: greatest expected rise and
    fall in the next `LATE_M`, at least zero.
    """

    here: float
    low: float
    high: float
    sigma: float
    height_sigma: float
    up: float
    down: float


class Residual:
    """Test of one wheel's preview; `feel` once a period. claim: what the last preview said."""

    claim: Claim

    def __init__(self, wheel: int, settings: GateSettings):
        self._wheel, self._settings = wheel, settings
        self._levels: tuple[float, float] | None = None
        self._rough = SMOOTH_M
        self._unannounced, self._contradicted, self._late = 0.0, 0.0, False

    def feel(self, felt_m: float, contact: bool, preview: RoadPreview, travelled_m: float) -> Strike:
        """Add the road height measured now, `travelled_m` after the last one; ignored while in the air."""
        self.claim = self._claim(preview)
        fade = exp(-travelled_m / FORGET_M)
        self._unannounced *= fade
        self._contradicted *= fade
        if contact:
            self._compare(felt_m, travelled_m)
        limit = self._settings.strike_m
        if self._contradicted > limit:
            return Strike.CONTRADICTED
        if self._unannounced > limit:
            return Strike.CONTRADICTED if self._late else Strike.UNANNOUNCED
        return Strike.CONSISTENT

    def _compare(self, felt_m: float, travelled_m: float) -> None:
        claimed, low, high, *_ = self.claim
        felt_level, claimed_level = self._levels or (felt_m, claimed)
        height, low, high = felt_m - felt_level, low - claimed_level, high - claimed_level
        size = max(-low, high)
        plain = size < PLAIN_M
        tolerated = self._settings.height_m + (ROUGHS_PLAIN if plain else ROUGHS_CLAIMED) * self._rough
        least, most = self._gains(size)
        above = height - max(least * high, most * high) - tolerated
        below = min(least * low, most * low) - tolerated - height
        if plain:
            self._unannounced += max(above, below, 0.0)
            self._late = self._follows(height)
            self._learn_roughness(abs(claimed - claimed_level - height), travelled_m)
        else:
            self._contradicted += max(above, below, 0.0)
        share = min(1.0, travelled_m / LEVEL_M)
        self._levels = felt_level + share * height, claimed_level + share * (claimed - claimed_level)

    def _claim(self, preview: RoadPreview) -> Claim:
        settings, wheel = self._settings, self._wheel
        rows = preview.existence[wheel], preview.height_m[wheel]
        sigmas = preview.position_sigma_m[wheel], preview.height_sigma_m[wheel]
        return Claim(*_told(preview.distance_m, *rows, *sigmas, settings.reach_m, settings.widest_m))

    def _gains(self, size_m: float) -> tuple[float, float]:
        """Smallest and largest tolerated ratio of measured to previewed height."""
        doubt = self._settings.gain + 2.0 * self.claim.height_sigma / max(size_m, _LEAST_SIZE_M)
        return max(self._settings.least_gain, 1.0 - doubt), 1.0 + doubt

    def _follows(self, height_m: float) -> bool:
        """Whether an obstacle like the one measured is previewed close ahead."""
        greatest = self.claim.up if height_m > 0.0 else self.claim.down
        return height_m != 0.0 and greatest > LATE_SHARE * abs(height_m)

    def _learn_roughness(self, error_m: float, travelled_m: float) -> None:
        """Update the roughness; an obstacle counts no more than twice the present value."""
        share = min(1.0, travelled_m / ROUGH_M)
        usual = min(max(error_m, SMOOTH_M), 2.0 * self._rough)
        self._rough += share * (usual - self._rough)


@njit
def expected_at(value: float, grid: Any, existence: Any, height: Any) -> float:
    """Expected height at one distance: that of the grid, existence times height, interpolated."""
    last, j = len(grid) - 1, cell(grid, value, 0)
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
def _told(
    grid: Any,
    existence: Any,
    height: Any,
    position_sigma: Any,
    height_sigma: Any,
    reach_m: float,
    widest_m: float,
) -> tuple[float, float, float, float, float, float, float]:
    """The numbers of a `Claim`; the place is tolerated within `reach_m` and its sigma, and `widest_m`."""
    sigma = interpolated(0.0, grid, position_sigma)
    reach = min(np.hypot(reach_m, sigma), widest_m)
    distances = np.empty(len(_SAMPLES))
    for i in range(len(distances)):
        distances[i] = reach * _SAMPLES[i]
    here, low, high = claims(distances, grid, existence, height)
    up, down = 0.0, 0.0
    for i in range(len(grid)):
        if 0.0 < grid[i] < LATE_M:
            up, down = max(up, existence[i] * height[i]), max(down, -existence[i] * height[i])
    return here, low, high, sigma, interpolated(0.0, grid, height_sigma), up, down
