"""Short random drives: a road of a few obstacles, a speed and a car."""

from pathlib import Path
from typing import Any

import numpy as np

from foreride.scenarios.definition.loading import structure
from foreride.scenarios.definition.schema import Scenario

_NOTHING_M = 2.0
_SIGHT_M = (14.0, 20.0)
"""Plain road before the first obstacle, in which a camera gets to know it."""


def drawn_road(rng: np.random.Generator) -> dict[str, Any]:
    """The fields of a scenario with a road that is short enough for a drive of a few seconds."""
    speed_kmh = float(rng.uniform(25.0, 70.0))
    features, place = [], _NOTHING_M + rng.uniform(*_SIGHT_M)
    for _ in range(rng.integers(1, 3)):
        features.append(_feature(float(round(place, 2)), rng))
        place += features[-1].get("length_m", 1.0) + rng.uniform(1.5, 12.0)
    road: dict[str, Any] = {"length_m": float(round(place + 2.0 + 0.15 * speed_kmh, 1)), "features": features}
    if (iso_class := str(rng.choice(["", "A", "B", "C"]))) != "":
        road["roughness"] = {"iso_class": iso_class, "seed": int(rng.integers(1000))}
    model = str(rng.choice(["quarter", "half"], p=[0.65, 0.35]))
    title = "Random road"
    return {"title": title, "speed_kmh": speed_kmh, "road": road, "vehicle": {"model": model}}


def scenario(fields: dict[str, Any], name: str) -> Scenario:
    """The validated scenario of such fields."""
    return structure({"name": name, **fields}, Path(f"{name}.yaml"))


def _feature(start_m: float, rng: np.random.Generator) -> dict[str, Any]:
    kind = str(
        rng.choice(
            ["half_sine_bump", "watts_hump", "flat_top_hump", "pothole", "expansion_joint"],
            p=[0.3, 0.15, 0.15, 0.35, 0.05],
        )
    )
    if kind == "expansion_joint":
        return {"kind": kind, "start_m": start_m}
    if kind == "pothole":
        size = {"depth_m": rng.uniform(0.03, 0.1), "length_m": rng.uniform(0.3, 1.0)}
        width = {"width_m": rng.uniform(0.5, 0.9), "y_m": -0.75, "seed": int(rng.integers(1000))}
        return {"kind": kind, "start_m": start_m, **_rounded(size | width)}
    length = rng.uniform(0.35, 1.0) if kind == "half_sine_bump" else rng.uniform(3.0, 6.0)
    size = {"height_m": rng.uniform(0.03, 0.1), "length_m": length}
    if kind == "flat_top_hump":
        size["ramp_m"] = rng.uniform(0.5, 1.2)
    return {"kind": kind, "start_m": start_m, **_rounded(size)}


def _rounded(values: dict[str, Any]) -> dict[str, Any]:
    return {name: round(float(v), 2) if isinstance(v, float) else v for name, v in values.items()}
