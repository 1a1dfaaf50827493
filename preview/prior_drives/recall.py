"""Conversion between an estimator's tracks and the `preview.prior_drives.memory_file` of a drive."""

import numpy as np

from foreride.preview.prior_drives.memory_file import (
    TEMPLATE_BY_NAME,
    Memory,
    Mounting,
    RememberedObject,
    RowBias,
    calibration_covariance,
    mounting_covariance,
)
from foreride.preview.settings import Settings
from foreride.preview.tracking.gauss_newton import HEIGHT, LENGTH, DirectMeasurement, X, fit, start_state
from foreride.preview.tracking.mounting_filter import MOUNTING, ROWS, Calibration
from foreride.preview.tracking.obstacle_templates import POTHOLE
from foreride.preview.tracking.track import LOG_ODDS_LIMIT, Edge, Track

_MIN_INFORMATION_RATIO = (
    0.05  # least information on a size, over that of the kind's prior, that counts as a measurement
)


def remember(calibration: Calibration, tracks: list[Track]) -> Memory:
    """Memory of a drive: the calibration and all confirmed `tracks`."""
    (pitch, cross, *with_pitch), (_, height, *with_height) = calibration.covariance[MOUNTING].tolist()
    (bump, both), (_, hole) = calibration.covariance[ROWS, ROWS].tolist()
    offset, lift, *rows = calibration.mean.tolist()
    return Memory(
        Mounting(offset, lift, pitch, cross, height),
        tuple(_to_memory(track) for track in tracks if track.confirmed),
        RowBias(tuple(rows), (bump, hole), both, tuple(with_pitch), tuple(with_height)),
    )


def recall(calibration: Calibration, memory: Memory) -> None:
    """Initialise the calibration with remembered mounting and edge bias."""
    kept = memory.mounting
    calibration.mean[MOUNTING] = kept.pitch_rad, kept.height_m
    if memory.rows is None:
        calibration.covariance[MOUNTING, MOUNTING] = mounting_covariance(kept)
    else:
        calibration.mean[ROWS] = memory.rows.bottom_px
        calibration.covariance = calibration_covariance(kept, memory.rows)


def expectations(
    memory: Memory, calibration: Calibration, settings: Settings, x_m: float, first: int = 0
) -> list[Track]:
    """Tracks of the remembered objects, numbered from `first`; the odometer starts at `x_m`."""
    return [
        _track_from_memory(number, place, calibration, settings, x_m)
        for number, place in enumerate(memory.objects, first)
    ]


def _to_memory(track: Track) -> RememberedObject:
    best = track.best
    (length, length_sigma), (height, height_sigma) = _measured(track, LENGTH), _measured(track, HEIGHT)
    if best.kind is POTHOLE and not track.depth_is_measured:
        height = height_sigma = None
    return RememberedObject(
        best.kind.name,
        float(best.state[X]),
        best.sigma_m,
        length,
        length_sigma,
        height,
        height_sigma,
        track.right.y_m,
        max(track.right.y_m, track.left.y_m),
        float(np.sqrt(max(track.right.variance, track.left.variance))),
        track.existence,
    )


def _measured(track: Track, entry: int) -> tuple[float, float] | tuple[None, None]:
    """Measured length or height with its sigma: the fit's, less the prior of the kind that it contains.

    The next fit adds the prior again; if kept in, it would count once more with every drive.
    """
    best = track.best
    usual, usual_sigma = {
        LENGTH: (best.kind.length_m, best.kind.length_sigma_m),
        HEIGHT: (best.kind.height_m, best.kind.height_sigma_m),
    }[entry]
    before, after = usual_sigma**-2, 1.0 / best.covariance[entry, entry]
    said = after - before
    if said < _MIN_INFORMATION_RATIO * before:
        return None, None
    value = float((after * best.state[entry] - before * usual) / said)
    return (value, float(said**-0.5)) if value > 0 else (None, None)


def _track_from_memory(
    identity: int, place: RememberedObject, calibration: Calibration, settings: Settings, x_m: float
) -> Track:
    kind = TEMPLATE_BY_NAME[place.kind]
    # Both drives' odometers have drifted by the time the object is reached.
    drift = np.sqrt(2.0) * settings.odometry_sigma * abs(place.x_m - x_m)
    directs = [DirectMeasurement(X, place.x_m, float(np.hypot(place.x_sigma_m, drift)))]
    if place.length_m is not None and place.length_sigma_m is not None:
        directs.append(DirectMeasurement(LENGTH, place.length_m, place.length_sigma_m))
    if place.height_m is not None and place.height_sigma_m is not None:
        directs.append(DirectMeasurement(HEIGHT, place.height_m, place.height_sigma_m))
    prior = calibration.prior(kind.cls)
    start = start_state(place.x_m, prior, place.length_m or kind.length_m, place.height_m or kind.height_m)
    best = fit(kind, [], start, prior, directs, settings)
    variance = place.y_sigma_m**2
    track = Track(
        identity,
        kind.cls,
        0.0,
        float(np.log(place.existence / (1 - place.existence))),
        Edge(place.y_min_m, variance),
        Edge(place.y_max_m, variance),
        [best],
        directs=directs,
        hits=0,
        class_log_odds=LOG_ODDS_LIMIT,
    )
    track.last_seen_x_m = place.x_m
    track.confirmed = track.existence > settings.confirm_existence
    return track
