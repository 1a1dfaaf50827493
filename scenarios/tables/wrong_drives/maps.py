"""Maps that are wrong: moved, scaled, stretched, mirrored, with holes, or of another road."""

from pathlib import Path
from typing import Any

import numpy as np

from foreride.files.writing.atomic import write_text
from foreride.road.road import Road

_STEP_M = 0.05
_TRACK_M = 0.75


def wrong_map(road: Road, other: Road, folder: Path, rng: np.random.Generator) -> dict[str, Any]:
    """Write a wrong map of the road into the folder; the scenario's field `map`."""
    x = np.arange(0.0, road.length_m, _STEP_M)
    kind = str(rng.choice(["moved", "scaled", "stretched", "mirrored", "holes", "other", "noisy"]))
    source, at, gain = road, x, 1.0
    if kind == "moved":
        at = x + rng.choice([-1.0, 1.0]) * rng.uniform(0.05, 1.0)
    elif kind == "stretched":
        at = x * rng.uniform(0.97, 1.03)
    elif kind == "other":
        source = other
    elif kind in ("scaled", "mirrored"):
        gain = float(rng.uniform(0.2, 3.0)) if kind == "scaled" else -1.0
    sides = [gain * source.height(at, np.full_like(at, y)) for y in (_TRACK_M, -_TRACK_M)]
    if kind == "holes":
        sides = [np.where(np.sin(x / rng.uniform(0.2, 2.0)) > 0.0, z, 0.0) for z in sides]
    if kind == "noisy":
        sides = [z + rng.uniform(0.002, 0.02) * rng.standard_normal(len(x)) for z in sides]
    sigma = float(rng.choice([0.0, 0.02, 0.1, 0.3]))
    lines = ["x_m,left_m,right_m,height_sigma_m,position_sigma_m,existence"]
    existence = float(rng.choice([1.0, 1.0, 0.6]))
    rows = zip(x, *sides, strict=True)
    lines += [f"{s:.3f},{left:.5f},{right:.5f},0.005,{sigma},{existence}" for s, left, right in rows]
    path = folder / f"{kind}_{rng.integers(1 << 60)}.csv"
    write_text(path, "\n".join(lines) + "\n")
    return {"file": str(path), "localisation_sigma_m": float(rng.choice([0.0, 0.05, 0.2]))}
