"""Ground-truth substitution in the estimator's tracks, to measure the cost of single errors."""

from collections.abc import Callable, Sequence
from dataclasses import replace

from foreride.preview.obstacle_classes import TEMPLATE_OF_FEATURE
from foreride.preview.tracking.height_likelihood import HeightSamples
from foreride.preview.tracking.object_state import HEIGHT, LENGTH, X
from foreride.preview.tracking.track import Track
from foreride.road.features.feature import Feature

_NEAR_M = 2.0

TrackCorrection = Callable[[Track, float], Track]
"""Maps a track and the odometer error (odometer minus truth, m) to the corrected track."""


def track_corrector(features: Sequence[Feature], told: Sequence[str]) -> TrackCorrection | None:
    """Build the correction that makes `distance` (near edge) or `shape` exact; None for an empty list.

    A track far from any feature of its class is left unchanged, as is the shape of kinds without a template.
    """
    if not told:
        return None

    def correct(track: Track, drift_m: float) -> Track:
        alike = [feature for feature in features if feature.cls == track.cls]
        offsets = [abs(feature.start_m + drift_m - track.start_m) for feature in alike]
        if not offsets or min(offsets) > _NEAR_M:
            return track
        return _corrected(track, alike[offsets.index(min(offsets))], drift_m, told)

    return correct


def _corrected(track: Track, feature: Feature, drift_m: float, told: Sequence[str]) -> Track:
    best, elevation = track.best, track.elevation
    state, kind = best.state.copy(), best.kind
    if "distance" in told:
        state[X] = feature.start_m + drift_m
    if "shape" in told and feature.kind in TEMPLATE_OF_FEATURE:
        kind = TEMPLATE_OF_FEATURE[feature.kind]
        state[LENGTH] = feature.end_m - feature.start_m
        state[HEIGHT] = abs(feature.crest_m)
        elevation = elevation or HeightSamples(1.0)  # a pothole keeps its measured depth
    return replace(track, fits=(best._replace(kind=kind, state=state),), elevation=elevation)
