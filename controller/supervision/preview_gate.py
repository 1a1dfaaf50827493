"""Consistency gate of the preview: trust in it, by comparison with the road measured at the front wheels.

Obstacles are compared by `controller.supervision.residual`, the road's texture by
`controller.supervision.correlation`. Comparison continues while the preview is dropped, so that trust can
return.
"""

import numpy as np

from foreride.controller.interface import Estimate
from foreride.controller.settings import GateSettings
from foreride.controller.supervision.correlation import Correlation
from foreride.controller.supervision.residual import Residual, Strike
from foreride.preview.road_preview import RoadPreview
from foreride.vehicle.load import Car

INCONSISTENT = "inconsistent preview"
LOSS = 0.5
"""Factor of the trust at a contradiction."""
GAP_S = 0.15
"""Longest time between two samples that are compared; a controller's period is 0.1 s at most."""
APART_M = 2.0
"""Contradictions closer together are one, as the high pass of the residuals echoes."""


class PreviewGate:
    """Gate with hysteresis; `check` once a period.

    A contradiction reduces the trust, time restores it. After an obstacle that was not announced the preview
    is suspended for some distance, as it may contain that obstacle farther ahead; the trust is kept.
    """

    def __init__(self, vehicle: Car, settings: GateSettings):
        places = np.array(vehicle.axle_x_m)
        self._front = [int(wheel) for wheel in np.flatnonzero(places == places.max())]
        self._settings = settings
        self._restart()
        self._trust, self._trusted = 1.0, True
        self._consistent_m = APART_M
        self._suspended_m = 0.0
        self._time_s: float | None = None

    def check(self, estimate: Estimate, preview: RoadPreview) -> str | None:
        """Return why the preview is dropped now, None if it is used."""
        since = estimate.time_s - self._time_s if self._time_s is not None else 0.0
        self._time_s = estimate.time_s
        if since > GAP_S:
            self._restart()
        travelled_m = estimate.speed_m_s * since
        strikes, alike = self._compare(estimate, preview, travelled_m)
        unannounced = Strike.UNANNOUNCED in strikes
        self._suspended_m = self._settings.aside_m if unannounced else self._suspended_m - travelled_m
        contradicted = Strike.CONTRADICTED in strikes
        self._update_trust(contradicted, since, travelled_m)
        believed = self._trusted and alike and not contradicted and self._suspended_m <= 0.0
        return None if believed else INCONSISTENT

    def _restart(self) -> None:
        """Begin the comparison anew, as after a gap; the trust is kept."""
        self._residuals = [Residual(wheel, self._settings) for wheel in self._front]
        self._correlations = [
            Correlation(self._settings.memory_m, self._settings.correlation) for _ in self._front
        ]

    def _update_trust(self, contradicted: bool, since_s: float, travelled_m: float) -> None:
        settings = self._settings
        self._trust = 1.0 - (1.0 - self._trust) * 0.5 ** (since_s / settings.half_life_s)
        self._consistent_m += travelled_m
        if contradicted:
            self._trust *= LOSS if self._consistent_m >= APART_M else 1.0
            self._consistent_m = 0.0
        self._trusted = self._trust >= (settings.lost if self._trusted else settings.regained)

    def _compare(
        self, estimate: Estimate, preview: RoadPreview, travelled_m: float
    ) -> tuple[list[Strike], bool]:
        """Test each front wheel; return the strikes, and whether all correlations hold."""
        strikes, alike = [], True
        for wheel, residual, correlation in zip(
            self._front, self._residuals, self._correlations, strict=True
        ):
            felt, contact = estimate.road_height.item(wheel), estimate.contact.item(wheel)
            strikes.append(residual.feel(felt, contact, preview, travelled_m))
            claimed = residual.claimed_m, residual.sigma_m
            alike = correlation.feel(felt, contact, *claimed, travelled_m) and alike
        return strikes, alike
