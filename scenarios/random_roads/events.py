"""Random events: road, speed and car, drawn from the event's number alone.

Of each twenty consecutive events every kind of `obstacles.KINDS` has its share. Obstacles lie on a road of
ISO 8608 class A, B, C or D, or on a smooth one; a tenth of the events each brakes or accelerates towards the
obstacle or over it. Speeds are uniform over the kind's range, together 15 to 90 km/h.

Events below `REPORTING` may be used to choose settings; nothing is chosen on those from there on.
"""

from pathlib import Path
from typing import Any

import numpy as np

from foreride.scenarios.definition.loading import structure
from foreride.scenarios.definition.overrides import Overrides
from foreride.scenarios.definition.schema import Scenario
from foreride.scenarios.definition.speed import KM_H
from foreride.scenarios.random_roads.cars import random_car, rounded
from foreride.scenarios.random_roads.obstacles import KINDS

REPORTING = 1000
"""Number of the first event that nothing is tuned on."""
START_M = 2.0
_CYCLE = tuple(kind for kind, entry in KINDS.items() for _ in range(entry.of_twenty))
_SMOOTH_SHARE = 0.15
_CLASSES = {"A": 0.35, "B": 0.4, "C": 0.2, "D": 0.05}
_ROUGH_CLASSES = {"A": 0.25, "B": 0.25, "C": 0.25, "D": 0.25}
_LIGHTS = ("noon", "overcast", "sunset")


def kind_of(number: int) -> str:
    """Kind of an event."""
    block, place = divmod(number, len(_CYCLE))
    return _CYCLE[np.random.default_rng([block, 0]).permutation(len(_CYCLE))[place]]


def event_scenario(number: int, overrides: Overrides = ()) -> Scenario:
    """The event as a scenario."""
    return structure(event_fields(number), Path(f"random_{number}.yaml"), overrides)


def event_fields(number: int) -> dict[str, Any]:
    """Fields of the event's scenario, as in a file."""
    rng = np.random.default_rng([number, 1])
    kind, car = kind_of(number), random_car(rng)
    low, high = KINDS[kind].speed_kmh
    speed_kmh = float(rng.uniform(low, high))
    start_kmh, way_m, past_m = _approach(rng, speed_kmh)
    first_m = START_M + car["front_axle_m"] + _sight_m(rng, start_kmh)
    features = KINDS[kind].draw(rng, car["track_m"])
    for feature in features:
        feature["start_m"] = round(feature["start_m"] + first_m, 2)
    return {
        "name": f"random_{number}",
        "title": f"Random road {number}, {kind}",
        **_speeds(start_kmh, speed_kmh, first_m - car["front_axle_m"] + past_m, way_m),
        "road": {"length_m": _end_m(features, first_m, car, speed_kmh), "features": features}
        | _roughness(rng, kind),
        "vehicle": {"model": "half", "parameters": car},
        "appearance": {"light": str(rng.choice(_LIGHTS)), "wear": rounded(float(rng.uniform(0.1, 0.6)))},
    }


def _approach(rng: np.random.Generator, speed_kmh: float) -> tuple[float, float, float]:
    """Initial speed, km/h, way to the later one (0: constant) and its end past the obstacle, m."""
    draw, acceleration = rng.random(), rng.uniform(1.0, 3.5)
    square = (speed_kmh * KM_H) ** 2
    way_m, past_m = min(rng.uniform(6.0, 14.0), 0.25 * square / acceleration), rng.uniform(-4.0, 4.0)
    if draw >= 0.2:
        return speed_kmh, 0.0, 0.0
    change = 2 * acceleration * way_m * (1.0 if draw < 0.1 else -1.0)
    return float(np.sqrt(square + change) / KM_H), float(way_m), float(past_m)


def _speeds(start_kmh: float, speed_kmh: float, end_m: float, way_m: float) -> dict[str, Any]:
    """Speed fields: constant, or changing over the last `way_m` before `end_m`."""
    if way_m == 0.0:
        return {"speed_kmh": rounded(speed_kmh)}
    before = {"at_m": round(end_m - way_m, 2), "kmh": rounded(start_kmh)}
    return {
        "speed_kmh": rounded(start_kmh),
        "speed": [before, {"at_m": round(end_m, 2), "kmh": rounded(speed_kmh)}],
    }


def _sight_m(rng: np.random.Generator, speed_kmh: float) -> float:
    """Plain road before the first obstacle: enough for a camera to see it come."""
    return float(max(18.0, 1.6 * speed_kmh * KM_H) + rng.uniform(0.0, 6.0))


def _end_m(features: list[dict[str, Any]], first_m: float, car: dict[str, Any], speed_kmh: float) -> float:
    """Length of the road: the rear wheels have passed, and the body has settled."""
    last = max(
        (f["start_m"] + f.get("length_m", 0.5) for f in features), default=first_m + 1.5 * speed_kmh * KM_H
    )
    wheelbase = car["front_axle_m"] + car["rear_axle_m"]
    return round(float(last + wheelbase + max(5.0, 1.3 * speed_kmh * KM_H)), 1)


def _roughness(rng: np.random.Generator, kind: str) -> dict[str, Any]:
    classes = _ROUGH_CLASSES if kind == "rough" else _CLASSES
    smooth, seed = rng.random() < _SMOOTH_SHARE, int(rng.integers(100_000))
    iso_class = str(rng.choice(list(classes), p=list(classes.values())))
    return {} if smooth and kind != "rough" else {"roughness": {"iso_class": iso_class, "seed": seed}}
