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
from foreride.preview.tracking.gauss_newton import DirectMeasurement, fit, start_state
from foreride.preview.tracking.mounting_filter import MOUNTING, ROWS, Calibration
from foreride.preview.tracking.object_state import HEIGHT, LENGTH, X
from foreride.preview.tracking.track import LOG_ODDS_LIMIT, Edge, Track

_MIN_INFORMATION_RATIO = (
    0.05  # least information on a size, over that of the kind's prior, that counts as a measurement
)

_LEAST_EXISTENCE = 0.8  # of a remembered object, which an earlier drive confirmed


def remember(calibration: Calibration, tracks: list[Track]) -> Memory:
    """Memory of a drive: the calibration and all confirmed `tracks`."""
    (pitch, covariance, *with_pitch), (_, height, *with_height) = calibration.covariance[MOUNTING].tolist()
    (bump, row_covariance), (_, hole) = calibration.covariance[ROWS, ROWS].tolist()
    pitch_rad, height_m, *rows = calibration.mean.tolist()
    return Memory(
        Mounting(pitch_rad, height_m, pitch, covariance, height),
        tuple(_to_memory(track) for track in tracks if track.confirmed),
        RowBias(tuple(rows), (bump, hole), row_covariance, tuple(with_pitch), tuple(with_height)),
    )


def recall(calibration: Calibration, memory: Memory) -> None:
    """Initialise the calibration with remembered mounting and edge bias."""
    mounting = memory.mounting
    calibration.mean[MOUNTING] = mounting.pitch_rad, mounting.height_m
    if memory.rows is None:
        calibration.covariance[MOUNTING, MOUNTING] = mounting_covariance(mounting)
    else:
        calibration.mean[ROWS] = memory.rows.bottom_px
        calibration.covariance = calibration_covariance(mounting, memory.rows)


def expectations(
    memory: Memory, calibration: Calibration, settings: Settings, x_m: float, first: int = 0
) -> list[Track]:
    """Tracks of the remembered objects, numbered from `first`; the odometer starts at `x_m`."""
    return [
        _track_from_memory(number, remembered, calibration, settings, x_m)
        for number, remembered in enumerate(memory.objects, first)
    ]


def _to_memory(track: Track) -> RememberedObject:
    best = track.best
    (length, length_sigma), (height, height_sigma) = _measured(track, LENGTH), _measured(track, HEIGHT)
    if best.kind.sign < 0 and not track.depth_is_measured:
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
    prior_mean, prior_sigma = {
        LENGTH: (best.kind.length_m, best.kind.length_sigma_m),
        HEIGHT: (best.kind.height_m, best.kind.height_sigma_m),
    }[entry]
    prior_information, posterior_information = prior_sigma**-2, 1.0 / best.covariance[entry, entry]
    information = posterior_information - prior_information
    if information < _MIN_INFORMATION_RATIO * prior_information:
        return None, None
    value = float((posterior_information * best.state[entry] - prior_information * prior_mean) / information)
    return (value, float(information**-0.5)) if value > 0 else (None, None)


def _track_from_memory(
    identity: int, remembered: RememberedObject, calibration: Calibration, settings: Settings, x_m: float
) -> Track:
    kind = TEMPLATE_BY_NAME[remembered.kind]
    # Both drives' odometers have drifted by the time the object is reached.
    drift = np.sqrt(2.0) * settings.odometry_sigma * abs(remembered.x_m - x_m)
    direct_measurements = [DirectMeasurement(X, remembered.x_m, float(np.hypot(remembered.x_sigma_m, drift)))]
    if remembered.length_m is not None and remembered.length_sigma_m is not None:
        direct_measurements.append(DirectMeasurement(LENGTH, remembered.length_m, remembered.length_sigma_m))
    if remembered.height_m is not None and remembered.height_sigma_m is not None:
        direct_measurements.append(DirectMeasurement(HEIGHT, remembered.height_m, remembered.height_sigma_m))
    prior = calibration.prior(kind.cls)
    start = start_state(
        remembered.x_m, prior, remembered.length_m or kind.length_m, remembered.height_m or kind.height_m
    )
    best = fit(kind, [], start, prior, direct_measurements, settings)
    variance = remembered.y_sigma_m**2
    track = Track(
        identity,
        kind.cls,
        0.0,
        float(np.log(remembered.existence / (1 - remembered.existence))),
        Edge(remembered.y_min_m, variance),
        Edge(remembered.y_max_m, variance),
        (best,),
        direct_measurements=direct_measurements,
        hits=0,
        class_log_odds=LOG_ODDS_LIMIT,
    )
    track.last_seen_x_m = remembered.x_m
    track.confirmed = remembered.existence > _LEAST_EXISTENCE
    return track
