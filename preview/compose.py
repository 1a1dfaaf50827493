"""Composition of the road preview of each wheel from confirmed tracks."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from foreride.files.interpolation import interpolate
from foreride.files.jit import njit
from foreride.preview.road_preview import RoadPreview
from foreride.preview.settings import Settings
from foreride.preview.tracking.obstacle_templates import tyre_profile
from foreride.preview.tracking.track import Track, relative_height_sigma
from foreride.road.tyre.tyre import Tyre

_MIN_OVERLAP = 0.02  # least probability of overlap for a wheel to meet the object


def compose(
    tracks: Sequence[Track],
    x_m: float,
    axle_x_m: tuple[float, ...],
    wheel_y_m: tuple[float, ...],
    distance_m: np.ndarray,
    settings: Settings,
    time_s: float,
    age_s: float,
    tyre: Tyre | None = None,
) -> RoadPreview:
    """Road preview of a car with odometer reading `x_m` and wheels at `axle_x_m` and `wheel_y_m` from it.

    Height is the effective height under the tyre if the object is real, times the probability that the wheel
    runs over it; `existence` is the probability that it is real. Unconfirmed tracks are left out.
    """
    shape = (len(axle_x_m), len(distance_m))
    height, existence, position_sigma, height_sigma = rows = np.zeros((4, *shape))
    height_sigma += settings.background_sigma_m
    for track in (track for track in tracks if track.confirmed):
        sigma = track.position_sigma_m(x_m, settings)
        for wheel, (axle, y) in enumerate(zip(axle_x_m, wheel_y_m, strict=True)):
            overlap = track.overlap(y)
            if overlap < _MIN_OVERLAP:
                continue
            section = track.section(y)
            edges = section.start_m, section.length_m, sigma
            shape_of_wheel = mixture(track, y, distance_m + x_m + axle, tyre or Tyre())
            told = overlap, track.existence, settings.background_sigma_m, *shape_of_wheel
            _enter(distance_m, x_m, axle, *edges, *told, rows[:, wheel])
    return RoadPreview(time_s, distance_m, height, position_sigma, height_sigma, existence, age_s)


@njit
def _enter(
    distance_m: Any,
    x_m: float,
    axle_m: float,
    start_m: float,
    length_m: float,
    sigma: float,
    overlap: float,
    existence: float,
    background_m: float,
    mean: Any,
    spread: Any,
    rows: Any,
) -> None:
    """Enter an object into the rows (4, n) of a wheel: height, existence, sigmas of position and height."""
    height, real, position_sigma, height_sigma = rows
    for i in range(len(distance_m)):
        expected, past_edge = overlap * mean[i], distance_m[i] + x_m + axle_m - start_m
        in_reach = -2 * sigma < past_edge < length_m + 2 * sigma
        # Overlapping tracks are one object tracked twice: the larger one represents both.
        if (expected != 0.0 or in_reach) and abs(expected) >= abs(height[i]):
            height[i], real[i], position_sigma[i] = expected, existence, sigma
            height_sigma[i] = np.hypot(background_m, overlap * spread[i])


class Shape(NamedTuple):
    """Probable shape of an object under the tyre: profile from its start on, probability, its mean square."""

    start_m: float
    profile_x: np.ndarray
    profile: np.ndarray
    share: float
    variance: float


def mixture(track: Track, y_m: float, x_m: np.ndarray, tyre: Tyre) -> tuple[np.ndarray, np.ndarray]:
    """Height under the tyre (n,) at positions `x_m` on the line y = `y_m`, and its standard deviation.

    Mean and spread of all probable kinds of shape, each with its own uncertainty of height.
    """
    mean, square = np.zeros((2, len(x_m)))
    for shape in _kept_shapes(track, y_m, tyre):
        _add_shape(x_m, *shape, mean, square)
    _spread(mean, square)
    return mean, square


def _kept_shapes(track: Track, y_m: float, tyre: Tyre) -> list[Shape]:
    """`_shapes` of the track, formed anew only when its fits or edges have changed."""
    state = *map(id, track.fits), track.left.y_m, track.right.y_m, tyre
    kept = track.shapes.get(y_m)
    if kept is None or kept[0] != state:
        # The fits are kept too, so that no new one has the identity of an old one.
        kept = track.shapes[y_m] = state, list(track.fits), _shapes(track, y_m, tyre)
    return kept[2]


def _shapes(track: Track, y_m: float, tyre: Tyre) -> list[Shape]:
    """All probable shapes of an object on the line y = `y_m`, each with its own uncertainty of height."""
    shapes = []
    for share, candidate in track.probable:
        section = track.section(y_m, candidate)
        profile = tyre_profile(candidate.kind, section.length_m, section.height_m, tyre)
        variance = share * (1.0 + relative_height_sigma(candidate) ** 2)
        shapes.append(Shape(section.start_m, *profile, share, variance))
    return shapes


@njit
def _add_shape(
    x_m: Any,
    start_m: float,
    profile_x: Any,
    profile: Any,
    share: float,
    variance: float,
    mean: Any,
    square: Any,
) -> None:
    """Add a shape's height, times its share, to the mean, and the height's mean square to `square`."""
    height = np.empty(len(x_m))
    interpolate(x_m - start_m, profile_x, profile, height)
    for i in range(len(x_m)):
        mean[i] += share * height[i]
        square[i] += variance * height[i] ** 2


@njit
def _spread(mean: Any, square: Any) -> None:
    """Replace the mean squares by the standard deviations."""
    for i in range(len(mean)):
        square[i] = np.sqrt(max(square[i] - mean[i] ** 2, 0.0))
