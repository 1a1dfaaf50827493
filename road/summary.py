"""Road summary: unevenness along lines of constant y, and the list of features."""

from dataclasses import asdict, dataclass, replace

import numpy as np

from foreride.files.errors import InputError
from foreride.road.road import FADE_IN_M, Road
from foreride.road.roughness.iri import iri
from foreride.road.roughness.psd_fit import fit, spectrum

STEP_M = 0.05


@dataclass(frozen=True)
class TrackSummary:
    """Unevenness along the line y = y_m, from the end of the fade-in to the end of the road.

    range_m: highest minus lowest point, features included. iri_m_km: IRI, features included; it needs 11 m of
    road. psd_n0_m3, waviness, iso_class: the fitted ISO 8608 line of the road without its features; they need
    40 m of rough road. None where a value cannot be determined.
    """

    y_m: float
    range_m: float
    iri_m_km: float | None
    psd_n0_m3: float | None
    waviness: float | None
    iso_class: str | None


def summarise_track(road: Road, y_m: float) -> TrackSummary:
    """Unevenness along one line of the road."""
    x = np.arange(min(FADE_IN_M, road.length_m), road.length_m, STEP_M)
    z = road.height(x, y_m)
    try:
        roughness = iri(z, STEP_M)
    except InputError:
        roughness = None
    try:
        line = fit(spectrum(replace(road, features=()).height(x, y_m), STEP_M))
    except InputError:
        line = None
    return TrackSummary(
        y_m=y_m,
        range_m=float(np.ptp(z)) if len(z) else 0.0,
        iri_m_km=roughness,
        psd_n0_m3=line and line.psd_n0_m3,
        waviness=line and line.waviness,
        iso_class=line and line.iso_class,
    )


def list_features(road: Road) -> list[dict[str, object]]:
    """All features in order of position, with all their dimensions."""
    return [{"kind": feature.kind, "end_m": feature.end_m, **asdict(feature)} for feature in road.features]
