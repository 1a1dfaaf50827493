"""Vertical alignment: piecewise constant grade joined by parabolic vertical curves."""

from dataclasses import dataclass
from typing import Annotated

import numpy as np
from annotated_types import Interval
from numpy.typing import ArrayLike, NDArray

from foreride.files.errors import InputError
from foreride.files.reading.ranges import Checked

MAX_GRADE = 0.3
_MAX_FEATURE_HEIGHT_M = 0.3  # greatest height of a feature over the alignment


@dataclass(frozen=True)
class GradeChange(Checked):
    """Change of grade to `grade` (m/m, negative downhill), from `start_m` on, over `length_m`.

    The vertical curve between is a parabola, as in road design. Raises InputError for a grade beyond
    ±0.3.
    """

    start_m: Annotated[float, Interval(ge=0.0, le=100_000.0), "m"]
    grade: Annotated[float, Interval(ge=-MAX_GRADE, le=MAX_GRADE), "m/m"]
    length_m: Annotated[float, Interval(ge=1e-3, le=10_000.0), "m"] = 2.0


def check_order(changes: tuple[GradeChange, ...], length_m: float) -> None:
    """Raise InputError unless the vertical curves follow one another within the road of `length_m`."""
    free_m = 0.0
    for index, change in enumerate(changes):
        end_m = change.start_m + change.length_m
        if change.start_m < free_m or end_m > length_m:
            raise InputError(
                f"grades[{index}] spans {change.start_m:g} to {end_m:g} m and must lie after the one before "
                f"it and inside the road, {free_m:g} to length_m = {length_m:g} m"
            )
        free_m = end_m


def grade_height(changes: tuple[GradeChange, ...], x: ArrayLike) -> NDArray[np.float64]:
    """Height (m) of the vertical alignment at x, same shape, 0 before the first of the ordered `changes`."""
    x = np.asarray(x, float)
    z, grade = np.zeros(x.shape), 0.0
    for change in changes:
        distance = np.maximum(x - change.start_m, 0.0)
        curve = np.minimum(distance, change.length_m)
        z += (change.grade - grade) * (curve**2 / (2 * change.length_m) + (distance - curve))
        grade = change.grade
    return z


def grade_at(changes: tuple[GradeChange, ...], x: float) -> float:
    """Grade (m/m) of the vertical alignment at x."""
    grade = 0.0
    for change in changes:
        share = min(max((x - change.start_m) / change.length_m, 0.0), 1.0)
        grade += (change.grade - grade) * share
    return grade


def min_descending_slope(changes: tuple[GradeChange, ...], x: float, z: float, far_m: float) -> float:
    """Least slope (m/m) of a plane ahead of a camera at x and z to which all rays to the road descend.

    far_m: distance ahead of the camera beyond which the road keeps its grade. 0 for a road without changes.
    """
    if not changes:
        return 0.0
    ahead = np.arange(1.0, far_m + 1.0)
    top = grade_height(changes, x + ahead) + _MAX_FEATURE_HEIGHT_M
    return max(grade_at(changes, x + far_m), float(((top - z) / ahead).max()))
