"""Random obstacles by kind, as features of a road block in a scenario.

Sizes follow design rules where there are such: heights of 25 to 100 mm, round-top, sinusoidal and flat-top
humps of about 3.7 m and more, cushions 60 to 80 mm high with ramps of 1:8 and side slopes of 1:4 (UK
Department for Transport, Local Transport Note 1/07, Traffic Calming; Highways (Road Humps) Regulations 1999),
and go beyond them as roads do. Bolt-on bumps and potholes have no rules; their ranges are 3 to 12 cm and 0.3
to 1.5 m.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from foreride.road.features.bumps import PAINTS
from foreride.scenarios.random_roads.cars import rounded

Features = list[dict[str, Any]]
Draw = Callable[[np.random.Generator, float], Features]
"""(generator, track of the car in m) → features; the first one starts at 0 m."""


class Kind(NamedTuple):
    """Kind of event: how its obstacles are drawn, how many of twenty events it is, and its speeds in km/h."""

    draw: Draw
    of_twenty: int
    speed_kmh: tuple[float, float]


def _bump(kind: str, rng: np.random.Generator, **size: float) -> Features:
    values = {name: rounded(float(value)) for name, value in size.items()}
    return [{"kind": kind, "start_m": 0.0, **values, "paint": str(rng.choice(PAINTS))}]


def _half_sine(rng: np.random.Generator, track_m: float) -> Features:
    return _bump("half_sine_bump", rng, height_m=rng.uniform(0.03, 0.12), length_m=rng.uniform(0.3, 1.2))


def _watts(rng: np.random.Generator, track_m: float) -> Features:
    return _bump("watts_hump", rng, height_m=rng.uniform(0.05, 0.12), length_m=rng.uniform(2.5, 5.0))


def _sinusoidal(rng: np.random.Generator, track_m: float) -> Features:
    return _bump("sinusoidal_hump", rng, height_m=rng.uniform(0.05, 0.12), length_m=rng.uniform(3.0, 5.5))


def _trapezoidal(rng: np.random.Generator, track_m: float) -> Features:
    ramps = {"ramp_up_m": rng.uniform(0.1, 0.45), "ramp_down_m": rng.uniform(0.1, 0.45)}
    length = sum(ramps.values()) + rng.uniform(0.1, 0.9)
    return _bump("trapezoidal_bump", rng, height_m=rng.uniform(0.03, 0.08), length_m=length, **ramps)


def _flat_top(rng: np.random.Generator, track_m: float) -> Features:
    height, ramp = rng.uniform(0.05, 0.11), rng.uniform(0.5, 1.4)
    length = 2 * ramp + rng.uniform(1.5, 6.0)
    return _bump("flat_top_hump", rng, height_m=height, length_m=length, ramp_m=ramp)


def _cushion(rng: np.random.Generator, track_m: float) -> Features:
    height, half, middle = rng.uniform(0.06, 0.08), rng.uniform(0.75, 0.95), rng.uniform(-0.5, 0.1)
    slopes = {"ramp_m": 8.0 * height, "taper_m": 4.0 * height}
    size = {"height_m": height, "length_m": rng.uniform(1.9, 3.7), **slopes}
    return _bump("speed_cushion", rng, **size, y_min_m=middle - half, y_max_m=middle + half)


def _pothole(rng: np.random.Generator, track_m: float) -> Features:
    length, width = rng.uniform(0.3, 1.5), rng.uniform(0.4, 1.1)
    size = {
        "length_m": length,
        "width_m": width,
        "depth_m": rng.uniform(0.03, 0.12),
        "wall_m": rng.uniform(0.03, 0.25) * min(length, width),
        "y_m": -track_m / 2 + rng.uniform(-0.15, 0.15),
    }
    seed = int(rng.integers(10_000))
    return [
        {"kind": "pothole", "start_m": 0.0, **{n: rounded(float(v)) for n, v in size.items()}, "seed": seed}
    ]


def _joint(rng: np.random.Generator, track_m: float) -> Features:
    gap, depth = rng.uniform(0.03, 0.12), rng.uniform(0.02, 0.05)
    lip = {"lip_m": rng.uniform(0.003, 0.012)} if rng.random() < 0.5 else {}
    size = {"gap_m": gap, "depth_m": depth, **lip}
    return [{"kind": "expansion_joint", "start_m": 0.0, **{n: rounded(float(v)) for n, v in size.items()}}]


def _repeated(draw: Draw, least: int, most: int, spacing_m: tuple[float, float]) -> Draw:
    def drawn(rng: np.random.Generator, track_m: float) -> Features:
        features: Features = []
        place = 0.0
        for _ in range(rng.integers(least, most + 1)):
            feature = draw(rng, track_m)[0] | {"start_m": round(place, 2)}
            features.append(feature)
            place = place + feature.get("length_m", 0.5) + rng.uniform(*spacing_m)
        return features

    return drawn


def _any_one(rng: np.random.Generator, track_m: float) -> Features:
    draws: list[Draw] = [_half_sine, _trapezoidal, _watts, _pothole, _pothole, _joint]
    return draws[rng.integers(len(draws))](rng, track_m)


def _nothing(rng: np.random.Generator, track_m: float) -> Features:
    return []


KINDS = {
    "half_sine": Kind(_half_sine, 3, (15.0, 45.0)),
    "watts": Kind(_watts, 2, (15.0, 50.0)),
    "sinusoidal": Kind(_sinusoidal, 2, (15.0, 50.0)),
    "trapezoidal": Kind(_trapezoidal, 2, (15.0, 50.0)),
    "flat_top": Kind(_flat_top, 2, (15.0, 50.0)),
    "cushion": Kind(_cushion, 1, (20.0, 60.0)),
    "pothole": Kind(_pothole, 4, (20.0, 90.0)),
    "chain": Kind(_repeated(_any_one, 2, 5, (1.0, 8.0)), 2, (20.0, 60.0)),
    "joints": Kind(_repeated(_joint, 3, 6, (5.0, 12.0)), 1, (40.0, 90.0)),
    "rough": Kind(_nothing, 1, (30.0, 90.0)),
}
