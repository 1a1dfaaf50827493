"""Seeded roads of many like obstacles, in some light and weather: what the estimator is measured on."""

from dataclasses import replace

import numpy as np

from files.errors import InputError
from road.appearance import Appearance
from road.features import Feature, FlatTopHump, HalfSineBump, Pothole, WattsHump
from road.profile import Road
from road.roughness import Roughness
from scenarios.schema import Scenario

COURSES = ("bumps", "humps", "potholes", "plain")
LOOKS = {
    "day": Appearance(light="noon", weather="dry"),
    "dusk": Appearance(light="sunset", weather="dry", sun_elevation_deg=8.0),
    "rain": Appearance(light="overcast", weather="rain"),
}
_FIRST_M = 40.0
_SPACING_M = (24.0, 34.0)
_PAINTS = ("plain", "yellow_black", "white_stripes", "white_triangles")


def course(
    base: Scenario, kind: str, look: str, seed: int, obstacles: int = 10, iso_class: str = "B"
) -> Scenario:
    """`base` on a road of `obstacles` obstacles of one of `COURSES`, seen in one of `LOOKS`, at 30-60 km/h.

    Sizes, paint, lateral positions, distances, speed and roughness are drawn from `seed`. `plain` has no
    obstacle on as long a road. Raises InputError for an unknown kind or look.
    """
    if kind not in COURSES:
        raise InputError(f"course must be one of {', '.join(COURSES)}, got {kind!r}")
    if look not in LOOKS:
        raise InputError(f"look must be one of {', '.join(LOOKS)}, got {look!r}")
    rng = np.random.default_rng((seed, COURSES.index(kind)))
    speed_kmh = float(rng.uniform(30.0, 60.0))
    starts = _FIRST_M + np.cumsum(rng.uniform(*_SPACING_M, obstacles))
    wheel_y = -base.vehicle.parameters.track_m / 2
    features = () if kind == "plain" else tuple(_draw(kind, float(x), wheel_y, rng) for x in starts)
    road = Road(
        length_m=float(starts[-1]) + 12.0,
        features=features,
        roughness=Roughness(iso_class, int(rng.integers(2**31)), track_m=base.vehicle.parameters.track_m),
    )
    wear = float(rng.uniform(0.1, 0.6))
    return replace(
        base,
        name=f"{kind}_{look}",
        title=f"{kind}, {look}, seed {seed}",
        road=road,
        speed_kmh=speed_kmh,
        appearance=replace(LOOKS[look], wear=wear),
    )


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
