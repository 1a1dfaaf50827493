"""Plausibility of measured roads: refused is what no road is, doubted what few roads are.

The limits: the steepest streets climb by a third of a metre within a metre, kerbs are 0.2 m high, and the
deepest potholes 0.3 m; IRI 20 m/km is an eroded unpaved road (Sayers, Gillespie, Paterson, World Bank
Technical Paper 46, 1986), and ASTM E1926 permits no spacing above 0.3 m.
"""

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from foreride.files.errors import InputError
from foreride.road.io.reading_options import proposal
from foreride.road.roughness.iri import INITIAL_SLOPE_BASE_M, MAX_STEP_M, iri

Array = NDArray[np.float64]
MAX_RISE_M, USUAL_RISE_M = 1.0, 0.4
"""Difference of height within a metre of road: refused and doubted above, m."""
USUAL_SPIKE_M = 0.15
USUAL_IRI = 30.0


def require_plausible(x: Array, y: Array, heights: Array, source: str) -> None:
    """Raise InputError for heights (m, n) that differ by more than MAX_RISE_M within a metre."""
    with np.errstate(over="ignore", invalid="ignore"):
        rise, line, station = steepest(x, heights)
    if rise <= MAX_RISE_M:
        return
    z = heights[line]
    with np.errstate(over="ignore", invalid="ignore"):
        largest_step = int(np.argmax(np.abs(np.diff(z))))
    for spike in (largest_step, largest_step + 1):
        if _spike(z, spike) > 0.5 * rise:
            raise InputError(
                f"{source}: the height {z[spike]:g} m at x = {x[spike]:g} m stands alone between "
                f"{z[spike - 1]:g} and {z[spike + 1]:g} m; if it marks a missing value, it must be left out"
            )
    unit, factor = ("mm", 1e-3) if rise > 2.0 else ("cm", 1e-2)
    hint = f"; in {unit} it would be {rise * factor:.4g} m: {proposal(unit=unit)}"
    raise InputError(
        f"{source}: heights change by {rise:.4g} m within a metre at x = {x[station]:g} m, allowed are "
        f"{MAX_RISE_M:g} m{hint if rise * factor <= MAX_RISE_M else ''}"
    )


def doubts(surface: Any, wheel_y_m: Sequence[float] = ()) -> Iterator[str]:
    """Properties of a `MeasuredSurface` that few roads have or that harm the ride's numbers, in a line each.

    wheel_y_m: lateral positions of the wheels that run over it.
    """
    x, heights = surface.x_m, surface.heights
    step_m, length_m = float(np.median(np.diff(x))), surface.length_m
    if step_m > MAX_STEP_M:
        yield (
            f"stations every {step_m:g} m lack the waves shorter than {2 * step_m:g} m, which cars feel; "
            f"{MAX_STEP_M:g} m or less are needed"
        )
    if length_m < INITIAL_SLOPE_BASE_M:
        yield (
            f"is {length_m:g} m long, too short for an IRI; if the stations are times in s: "
            f"{proposal(speed='KMH')}"
        )
    rise, line, station = steepest(x, heights)
    if rise > USUAL_RISE_M:
        yield f"heights change by {rise:.3g} m within a metre at x = {x[station]:g} m; is the unit right?"
    step = int(np.argmax(np.abs(np.diff(heights[line]))))
    size, at = max((_spike(heights[line], k), k) for k in (step, step + 1))
    if size > USUAL_SPIKE_M:
        yield f"the height at x = {x[at]:g} m stands alone, {size:.3g} m off both its neighbours"
    if step_m <= MAX_STEP_M and length_m >= INITIAL_SLOPE_BASE_M:
        lines = (own_stations(surface, k) for k in {0, len(heights) - 1})
        roughness = max(iri(z, step_m) for step_m, z in lines)
        if roughness > USUAL_IRI:
            yield f"has an IRI of {roughness:.0f} m/km, eroded unpaved roads have 20; is the unit right?"
    if surface.filled_m:
        yield f"{surface.filled_m:g} m of it had missing heights, filled with the last height across"
    yield from _beside(surface.y_m, wheel_y_m)


def _beside(y: Array, wheel_y_m: Sequence[float]) -> Iterator[str]:
    outside = sorted(w for w in set(wheel_y_m) if len(y) > 1 and not y[0] - 1e-6 <= w <= y[-1] + 1e-6)
    if outside:
        wheels = " and ".join(f"{w:g}" for w in outside)
        yield (
            f"covers y = {y[0]:g} ... {y[-1]:g} m; the wheels at y = {wheels} m run beside it, "
            "at the height of its border"
        )


def own_stations(surface: Any, line: int) -> tuple[float, Array]:
    """Spacing (m) and heights of a line at the surface's own stations; at even ones if these are not even."""
    x, z = surface.x_m, surface.heights[line]
    steps = np.diff(x)
    step_m = float(x[-1] / (len(x) - 1))
    if np.ptp(steps) <= 0.01 * step_m:
        return step_m, z
    step_m = float(np.median(steps))
    return step_m, np.interp(step_m * np.arange(int(x[-1] / step_m) + 1), x, z)


def steepest(x: Array, heights: Array) -> tuple[float, int, int]:
    """Largest difference of height within a metre, and the line and the station where it begins."""
    ahead = np.maximum(np.searchsorted(x, x + 1.0, side="right") - 1, 0)
    best = (0.0, 0, 0)
    for line, z in enumerate(heights):
        for other in (np.minimum(np.arange(len(x)) + 1, len(x) - 1), ahead):
            rises = np.abs(z[other] - z) / np.maximum(1.0, x[other] - x)
            station = int(np.argmax(rises))
            if not rises[station] <= best[0]:
                best = (float(rises[station]), line, station)
    return best


def _spike(z: Array, station: int) -> float:
    """Distance of a height from both its neighbours, 0 unless these agree."""
    if not 0 < station < len(z) - 1:
        return 0.0
    before, after = abs(z[station] - z[station - 1]), abs(z[station] - z[station + 1])
    return float(min(before, after)) if abs(z[station + 1] - z[station - 1]) < 0.2 * before else 0.0
