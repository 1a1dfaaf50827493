"""Shapes of a track under the wheels: what each wheel may meet of an object, kept until its track changes."""

from typing import Any, NamedTuple

import numpy as np

from foreride.files.interpolation import between
from foreride.files.jit import njit
from foreride.preview.tracking.obstacle_templates import tyre_profile
from foreride.preview.tracking.track import Track, relative_height_sigma
from foreride.road.tyre.tyre import Tyre


class WheelShapes(NamedTuple):
    """Shapes of an object under the wheels.

    edges: (wheels, 3) probability that the wheel runs over the object, near edge and length on its line.
    shapes: (k, 6) wheel of each probable shape, its start, probability, that times the mean square of its
    relative height, and first and last index of its profile. profile_x, profile: (n,) profiles under the
    tyre, one after another, from their start on; zero at both ends.
    """

    edges: np.ndarray
    shapes: np.ndarray
    profile_x: np.ndarray
    profile: np.ndarray


def wheel_shapes(track: Track, wheel_y_m: tuple[float, ...], tyre: Tyre) -> WheelShapes:
    """Shapes under wheels on the lines y = `wheel_y_m`, formed anew only when fits or edges have changed."""
    fits, left, right = track.fits, track.left, track.right
    state = left.y_m, left.variance, right.y_m, right.variance, wheel_y_m, tyre
    if track.shapes is None or track.shapes[0] is not fits or track.shapes[1] != state:
        track.shapes = fits, state, _formed(track, wheel_y_m, tyre)
    found: WheelShapes = track.shapes[2]
    return found


def _formed(track: Track, wheel_y_m: tuple[float, ...], tyre: Tyre) -> WheelShapes:
    edges, shapes, profiles, last = np.empty((len(wheel_y_m), 3)), [], [], -1
    probable = track.probable
    for wheel, y in enumerate(wheel_y_m):
        best = track.section(y)
        edges[wheel] = track.overlap(y), best.start_m, best.length_m
        for share, candidate in probable:
            section = track.section(y, candidate)
            profile = tyre_profile(candidate.kind, section.length_m, section.height_m, tyre)
            variance = share * (1.0 + relative_height_sigma(candidate) ** 2)
            first, last = last + 1, last + len(profile[0])
            shapes.append((wheel, section.start_m, share, variance, first, last))
            profiles.append(profile)
    return WheelShapes(edges, np.array(shapes), *np.concatenate(profiles, axis=1))


@njit
def mixture(
    wheel: int, x_m: Any, shapes: Any, profile_x: Any, profile: Any, height_m: Any, sigma_m: Any
) -> None:
    """Write height under the tyre and its standard deviation at ascending positions `x_m` (n,) into (n,).

    Mean and spread of all probable shapes under the wheel, each with its own uncertainty of height.
    """
    height_m[:] = 0.0
    sigma_m[:] = 0.0
    for k in range(len(shapes)):
        _, start_m, share, variance, first, last = shapes[k]
        if shapes[k, 0] == wheel:
            grid, heights = profile_x[int(first) : int(last) + 1], profile[int(first) : int(last) + 1]
            _add_shape(x_m, start_m, share, variance, grid, heights, height_m, sigma_m)
    for i in range(len(x_m)):
        sigma_m[i] = np.sqrt(max(sigma_m[i] - height_m[i] ** 2, 0.0))


@njit
def _add_shape(
    x_m: Any, start_m: float, share: float, variance: float, grid: Any, heights: Any, mean: Any, square: Any
) -> None:
    """Add a shape's height, times its share, to the mean, and the height's mean square to `square`.

    At ascending positions; outside the profile the height is zero.
    """
    last, j = len(grid) - 1, 0
    for i in range(len(x_m)):
        value = x_m[i] - start_m
        if value < grid[0]:
            continue
        if value >= grid[last]:
            break
        while grid[j + 1] <= value:
            j += 1
        height = between(grid[j], grid[j + 1], heights[j], heights[j + 1], value)
        mean[i] += share * height
        square[i] += variance * height**2
