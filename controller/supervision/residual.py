"""Residual between felt and claimed road height of one wheel, with unknown but bounded errors of the claim.

A set-membership test: the preview with its tolerances bounds what may be felt (Milanese & Vicino, Automatica
27(6), 1991); what lies outside is summed with forgetting, as in the CUSUM test (Page, Biometrika 41, 1954).
"""

from enum import Enum

import numpy as np

from foreride.controller.settings import GateSettings
from foreride.preview.road_preview import RoadPreview

FORGET_M = 0.1
"""Distance constant of the sums."""
PLAIN_M = 0.01
"""Height below which a claim announces nothing."""
LEVEL_M, HELD_M = 2.0, 10.0
"""Distance constants of the felt road's level, on plain road and at announced obstacles."""
ROUGH_M = 10.0
"""Distance constant of the roughness."""
SMOOTH_M = 0.002
"""Least roughness."""
ROUGHS_PLAIN, ROUGHS_CLAIMED = 3.0, 2.0
"""Roughnesses that are tolerated, on plain road and at announced obstacles."""
_SAMPLES = np.linspace(-1.0, 1.0, 7)
_LEAST_SIZE_M = 0.02


class Strike(Enum):
    """What was felt lately: as claimed, an obstacle not announced, or not what was announced."""

    CONSISTENT = "consistent"
    UNANNOUNCED = "unannounced"
    CONTRADICTED = "contradicted"


class Residual:
    """Test of one wheel's preview; `feel` once a period."""

    def __init__(self, wheel: int, settings: GateSettings):
        self._wheel, self._settings = wheel, settings
        self._level: float | None = None
        self._rough = SMOOTH_M
        self._unannounced, self._contradicted = 0.0, 0.0

    def feel(self, felt_m: float, contact: bool, preview: RoadPreview, travelled_m: float) -> Strike:
        """Add the road height felt now, `travelled_m` after the last one; ignored while in the air."""
        fade = float(np.exp(-travelled_m / FORGET_M))
        self._unannounced *= fade
        self._contradicted *= fade
        if contact:
            self._compare(felt_m, preview, travelled_m)
        limit = self._settings.strike_m
        if self._contradicted > limit:
            return Strike.CONTRADICTED
        return Strike.UNANNOUNCED if self._unannounced > limit else Strike.CONSISTENT

    def _compare(self, felt_m: float, preview: RoadPreview, travelled_m: float) -> None:
        claimed, low, high = self._claims(preview)
        size = max(-low, high)
        plain = size < PLAIN_M
        if self._level is None:
            self._level = felt_m - claimed
        height = felt_m - self._level
        roughs = ROUGHS_PLAIN if plain else ROUGHS_CLAIMED
        tolerated = self._settings.height_m + roughs * self._rough
        least, most = self._gains(preview, size)
        above = height - max(least * high, most * high) - tolerated
        below = min(least * low, most * low) - tolerated - height
        if plain:
            self._unannounced += max(above, below, 0.0)
            self._learn_roughness(abs(height - claimed), travelled_m)
        else:
            self._contradicted += max(above, below, 0.0)
        self._level += min(1.0, travelled_m / (LEVEL_M if plain else HELD_M)) * (height - claimed)

    def _claims(self, preview: RoadPreview) -> tuple[float, float, float]:
        """Height claimed here, and lowest and highest claim within the tolerated position error."""
        settings, wheel = self._settings, self._wheel
        sigma = np.interp(0.0, preview.distance_m, preview.position_sigma_m[wheel])
        reach = min(float(np.hypot(settings.reach_m, sigma)), settings.widest_m)
        heights = preview.existence[wheel] * preview.height_m[wheel]
        near = np.interp(reach * _SAMPLES, preview.distance_m, heights)
        return float(near[len(near) // 2]), float(near.min()), float(near.max())

    def _gains(self, preview: RoadPreview, size_m: float) -> tuple[float, float]:
        """Smallest and largest tolerated ratio of felt to claimed height."""
        sigma = float(np.interp(0.0, preview.distance_m, preview.height_sigma_m[self._wheel]))
        doubt = self._settings.gain + 2.0 * sigma / max(size_m, _LEAST_SIZE_M)
        return max(self._settings.least_gain, 1.0 - doubt), 1.0 + doubt

    def _learn_roughness(self, error_m: float, travelled_m: float) -> None:
        """Update the RMS on plain road; an obstacle counts no more than three times the present value."""
        error = min(max(error_m, SMOOTH_M), 3.0 * self._rough)
        share = min(1.0, travelled_m / ROUGH_M)
        self._rough = float(np.sqrt((1.0 - share) * self._rough**2 + share * error**2))
