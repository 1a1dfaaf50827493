"""Seeded roads with many obstacles of one kind, in a given lighting and weather."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import cycle

import numpy as np

from foreride.files.errors import InputError
from foreride.road.features.feature import Feature, FlatTopHump, HalfSineBump, Pothole, WattsHump
from foreride.road.render.appearance import Appearance
from foreride.road.road import Road
from foreride.road.roughness.iso8608 import Roughness
from foreride.road.vertical_alignment import GradeChange
from foreride.scenarios.definition.schema import Scenario
from foreride.scenarios.definition.speed import KM_H, SpeedPoint

COURSES = ("bumps", "humps", "potholes", "plain")
LOOKS = {
    "day": Appearance(light="noon", weather="dry"),
    "dusk": Appearance(light="sunset", weather="dry", sun_elevation_deg=8.0),
    "rain": Appearance(light="overcast", weather="rain"),
}
MIXED = "mixed"  # all LOOKS in turn, road by road
MAX_BRAKING_M_S2, MAX_GRADE = 8.0, 0.05
_FIRST_M = 40.0
_SPACING_M = (24.0, 34.0)
_BRAKING_M, _SLOW_M = 8.0, 6.0  # before an obstacle, and from its near edge on
_GRADE_LEAD_M = (5.0, 15.0)  # from a change of grade to the next obstacle
_PAINTS = ("plain", "yellow_black", "white_stripes", "white_triangles")


def course(
    base: Scenario,
    kind: str,
    look: str,
    seed: int,
    obstacles: int = 10,
    *,
    braking_m_s2: float = 0.0,
    grade: float = 0.0,
) -> Scenario:
    """Return `base` on a road with `obstacles` of one of `COURSES`, in one of `LOOKS`, at 30-60 km/h.

    Sizes, paint, lateral positions, distances, speed and roughness (class B) are drawn from `seed`. `plain`
    has no obstacle on a road of the same length; the look `mixed` is one of LOOKS, by the seed.

    Args:
        braking_m_s2: deceleration until the front wheels reach an obstacle; the car then accelerates again.
        grade: change of the road's grade (m/m) before each obstacle: up, level, down, level.

    Raises InputError for an unknown kind or look, no obstacle, or more braking or grade than allowed.
    """
    if kind not in COURSES:
        raise InputError(f"course must be one of {', '.join(COURSES)}, got {kind!r}")
    if look not in (*LOOKS, MIXED):
        raise InputError(f"look must be one of {', '.join(LOOKS)}, {MIXED}, got {look!r}")
    if obstacles < 1:
        raise InputError(f"obstacles must be >= 1, got {obstacles}")
    _check("braking", braking_m_s2, MAX_BRAKING_M_S2)
    _check("grade", grade, MAX_GRADE)
    rng = np.random.default_rng((seed, COURSES.index(kind)))
    speed_kmh = float(rng.uniform(30.0, 60.0))
    starts = [float(x) for x in _FIRST_M + np.cumsum(rng.uniform(*_SPACING_M, obstacles))]
    car = base.vehicle.parameters
    wheel_y = -car.track_m / 2
    features = () if kind == "plain" else tuple(_draw(kind, x, wheel_y, rng) for x in starts)
    roughness = Roughness("B", int(rng.integers(2**31)), track_m=car.track_m)
    wear = float(rng.uniform(0.1, 0.6))
    grades = _grades(starts, grade, rng) if grade else ()
    shown = LOOKS[list(LOOKS)[seed % len(LOOKS)] if look == MIXED else look]
    return replace(
        base,
        name=f"{kind}_{look}",
        title=f"{kind}, {look}, seed {seed}",
        road=Road(length_m=starts[-1] + 12.0, features=features, roughness=roughness, grades=grades),
        speed_kmh=speed_kmh,
        speed=_stops(starts, max(car.axle_x_m), speed_kmh, braking_m_s2) if braking_m_s2 else (),
        appearance=replace(shown, wear=wear),
    )


def _check(name: str, value: float, maximum: float) -> None:
    if not 0.0 <= value <= maximum:
        raise InputError(f"{name} must lie in 0 ... {maximum:g}, got {value:g}")


def _stops(
    starts: Sequence[float], axle_m: float, speed_kmh: float, braking_m_s2: float
) -> tuple[SpeedPoint, ...]:
    """Speed points: slower before each obstacle, but never below half, and back to `speed_kmh` after it."""
    square = (speed_kmh * KM_H) ** 2
    span = min(_BRAKING_M, 0.75 * square / (2 * braking_m_s2))
    slow_kmh = float(np.sqrt(square - 2 * braking_m_s2 * span)) / KM_H
    points = []
    for start in starts:
        at = start - axle_m
        positions = (
            (speed_kmh, at - span),
            (slow_kmh, at),
            (slow_kmh, at + _SLOW_M),
            (speed_kmh, at + _SLOW_M + span),
        )
        points += [SpeedPoint(kmh, at_m=position_m) for kmh, position_m in positions]
    return tuple(points)


def _grades(starts: Sequence[float], grade: float, rng: np.random.Generator) -> tuple[GradeChange, ...]:
    """One change of grade before each obstacle; the road stays within decimetres of its initial height."""
    steps = zip(starts, cycle((grade, 0.0, -grade, 0.0)))
    return tuple(GradeChange(start - float(rng.uniform(*_GRADE_LEAD_M)), to) for start, to in steps)


def _draw(kind: str, x: float, wheel_y: float, rng: np.random.Generator) -> Feature:
    if kind == "bumps":
        height, length = rng.uniform(0.05, 0.10), rng.uniform(0.35, 0.60)
        return HalfSineBump(x, float(height), float(length), paint=str(rng.choice(_PAINTS)))
    if kind == "humps":
        height, paint = float(rng.uniform(0.07, 0.11)), str(rng.choice(_PAINTS))
        if rng.random() < 0.5:
            return WattsHump(x, height, float(rng.uniform(3.0, 4.3)), paint=paint)
        length = float(rng.uniform(3.0, 4.3))
        return FlatTopHump(x, height, length, ramp_m=float(length * rng.uniform(0.14, 0.22)), paint=paint)
    return Pothole(
        x,
        depth_m=float(rng.uniform(0.05, 0.10)),
        length_m=float(rng.uniform(0.6, 1.0)),
        width_m=float(rng.uniform(0.6, 1.0)),
        y_m=wheel_y + float(rng.uniform(-0.15, 0.15)),
        seed=int(rng.integers(2**31)),
    )
