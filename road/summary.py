"""Road summary: unevenness along lines of constant y and in segments, and the list of features."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from foreride.files.errors import InputError
from foreride.road.io.plausibility import own_stations
from foreride.road.io.surface_file import MeasuredSurface
from foreride.road.road import FADE_IN_M, Road
from foreride.road.roughness.iri import MAX_STEP_M, iri, rectified_slope
from foreride.road.roughness.psd_fit import FittedPsdLine, fit, spectrum

STEP_M = 0.05
SEGMENTS_M = (20.0, 100.0)
"""Lengths of the segments in which roads are reported, m."""

Array = NDArray[np.float64]


@dataclass(frozen=True)
class TrackSummary:
    """Unevenness along the line y = y_m, from `start_m` to the end of the road, at stations every `step_m`.

    range_m: highest minus lowest point, features included. iri_m_km: IRI, features included; it needs 11 m of
    road and stations of at most 0.3 m. psd_n0_m3, its 90 % interval psd_low_m3 ... psd_high_m3, waviness,
    iso_class (a range such as "A-B" if the interval touches several): the fitted ISO 8608 line of the road
    without its features; they need 40 m of rough road. None where a value cannot be determined.
    """

    y_m: float
    start_m: float
    step_m: float
    range_m: float
    iri_m_km: float | None
    psd_n0_m3: float | None
    psd_low_m3: float | None
    psd_high_m3: float | None
    waviness: float | None
    iso_class: str | None


class Track(NamedTuple):
    """Heights (n,) along the line y = y_m from `start_m` on, every `step_m`; `bare` without features."""

    y_m: float
    start_m: float
    step_m: float
    heights: Array
    bare: Array


class Segment(NamedTuple):
    """IRI (m/km) of a stretch of road."""

    start_m: float
    end_m: float
    iri_m_km: float


def road_track(road: Road, y_m: float) -> Track:
    """Track of a road from the end of its fade-in."""
    start_m = min(FADE_IN_M, road.length_m)
    x = np.arange(start_m, road.length_m, STEP_M)
    bare = replace(road, features=()).height(x, y_m)
    return Track(y_m, start_m, STEP_M, road.height(x, y_m), bare)


def measured_tracks(surface: MeasuredSurface, wheel_y_m: Sequence[float]) -> list[Track]:
    """Tracks of a measured surface over its whole length, at its own stations, or at even ones."""
    tracks = []
    for y_m in wheel_y_m:
        line = surface._replace(y_m=np.array([y_m]), heights=surface.height(surface.x_m, y_m)[None])
        step_m, heights = own_stations(line, 0)
        tracks.append(Track(y_m, 0.0, step_m, heights, heights))
    return tracks


def summarise(track: Track) -> TrackSummary:
    """Unevenness along one track."""
    line = _fitted(track)
    return TrackSummary(
        y_m=track.y_m,
        start_m=track.start_m,
        step_m=track.step_m,
        range_m=float(np.ptp(track.heights)) if len(track.heights) else 0.0,
        iri_m_km=_iri(track),
        psd_n0_m3=line and line.psd_n0_m3,
        psd_low_m3=line and line.low_m3,
        psd_high_m3=line and line.high_m3,
        waviness=line and line.waviness,
        iso_class=line and line.iso_class,
    )


def summarise_track(road: Road, y_m: float) -> TrackSummary:
    """Unevenness along one line of the road."""
    return summarise(road_track(road, y_m))


def segments(track: Track, length_m: float) -> list[Segment]:
    """IRI of each stretch of `length_m`, from one run over the whole track; empty if that has no IRI."""
    if _iri(track) is None:
        return []
    slopes = rectified_slope(track.heights, track.step_m)
    count = round(length_m / track.step_m)
    end_m = track.start_m + (len(track.heights) - 1) * track.step_m
    starts = range(0, len(slopes), count)
    return [
        Segment(
            track.start_m + start * track.step_m,
            min(track.start_m + (start + count) * track.step_m, end_m),
            float(np.mean(slopes[start : start + count]) * 1000),
        )
        for start in starts
        if len(track.heights) - 1 - start >= count / 2 or start == 0
    ]


def _iri(track: Track) -> float | None:
    try:
        return iri(track.heights, track.step_m)
    except InputError:
        return None


def _fitted(track: Track) -> FittedPsdLine | None:
    if track.step_m > MAX_STEP_M:
        return None
    try:
        return fit(spectrum(track.bare, track.step_m))
    except InputError:
        return None


def list_features(road: Road) -> list[dict[str, object]]:
    """All features in order of position, with all their dimensions."""
    return [{"kind": feature.kind, "end_m": feature.end_m, **asdict(feature)} for feature in road.features]
