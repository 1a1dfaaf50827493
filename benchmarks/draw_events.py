"""Generation of the event sets for tuning and for reporting: `python -m benchmarks.draw_events`.

Both sets are drawn from the same ranges with different seeds, so that no event is in both. Within a kind,
sizes and speeds form a Latin hypercube: they cover their ranges evenly and involve no manual choice.
"""

from pathlib import Path
from typing import Any

import numpy as np
import yaml
from scipy.stats import qmc

from foreride.files.writing.atomic import write_text

FOLDER = Path(__file__).parents[1] / "scenarios" / "library" / "sets"
RANGES: dict[str, dict[str, tuple[float, float]]] = {
    "half_sine_bump": {"speed_kmh": (15, 40), "height_m": (0.05, 0.10), "length_m": (0.35, 0.90)},
    "watts_hump": {"speed_kmh": (20, 45), "height_m": (0.07, 0.10), "length_m": (3.0, 4.5)},
    "flat_top_hump": {
        "speed_kmh": (20, 40),
        "height_m": (0.07, 0.10),
        "length_m": (3.6, 7.0),
        "ramp_m": (0.6, 1.5),
    },
    "pothole": {
        "speed_kmh": (30, 70),
        "depth_m": (0.04, 0.10),
        "length_m": (0.30, 1.00),
        "width_m": (0.40, 0.90),
    },
}
REPORTING = {"half_sine_bump": 6, "watts_hump": 3, "flat_top_hump": 3, "pothole": 7}
REPORTING_ROUGH = (("A", 90), ("B", 80), ("C", 60))
TUNING = {"half_sine_bump": 2, "watts_hump": 1, "flat_top_hump": 1, "pothole": 2}
FEW = ("half_sine_bump_1", "flat_top_hump_0", "pothole_0")
TUNING_ROUGH = (("B", 70), ("C", 50))


def main() -> None:
    rng = np.random.default_rng(101)
    events = features(REPORTING, rng, approach_m=30.0, after_s=1.8) + roughs(REPORTING_ROUGH, 4.0, rng)
    events += [mixed(f"mixed_{index}", iso_class, rng) for index, iso_class in enumerate("AB")]
    write("reporting", "Events on which results are reported; no setting is chosen on them.", events)
    rng = np.random.default_rng(202)
    events = features(TUNING, rng, approach_m=5.0, after_s=1.2) + roughs(TUNING_ROUGH, 2.0, rng)
    write("tuning", "Events on which `foreride tune` chooses settings; none is reported.", events)
    few = [event for event in events if event["name"] in FEW]
    write("tuning_short", "A few of the events for tuning, for machines with little time.", few)


def features(
    counts: dict[str, int], rng: np.random.Generator, approach_m: float, after_s: float
) -> list[dict[str, Any]]:
    """One event per feature: a flat road with it, `approach_m` ahead; the drive continues for `after_s`."""
    events = []
    for kind, count in counts.items():
        for index, sizes in enumerate(sample(kind, count, rng)):
            speed = sizes.pop("speed_kmh")
            feature = place(kind, sizes, 2.0 + approach_m, rng)
            length = 2.0 + approach_m + sizes["length_m"] + 3.0 + after_s * speed / 3.6
            road = {"length_m": float(np.ceil(length)), "features": [feature]}
            events.append(
                {"name": f"{kind}_{index}", "title": title(feature, speed), "speed_kmh": speed, "road": road}
            )
    return events


def roughs(
    classes: tuple[tuple[str, int], ...], duration_s: float, rng: np.random.Generator
) -> list[dict[str, Any]]:
    """Rough roads without features, with their ISO 8608 class and speed in km/h."""
    return [
        {
            "name": f"rough_{iso_class.lower()}",
            "title": f"ISO 8608 class {iso_class}, {speed} km/h",
            "speed_kmh": speed,
            "road": {
                "length_m": float(np.ceil(5.0 + duration_s * speed / 3.6)),
                "roughness": {"iso_class": iso_class, "seed": int(rng.integers(1000))},
            },
        }
        for iso_class, speed in classes
    ]


def mixed(name: str, iso_class: str, rng: np.random.Generator) -> dict[str, Any]:
    """Rough road with a bump, a pothole and a hump."""
    placed, start = [], 32.0
    for kind in ("half_sine_bump", "pothole", "watts_hump"):
        sizes = sample(kind, 1, rng)[0]
        del sizes["speed_kmh"]
        placed.append(place(kind, sizes, start, rng))
        start += float(np.round(rng.uniform(18.0, 30.0)))
    speed = int(rng.integers(30, 45))
    return {
        "name": name,
        "title": f"Class {iso_class} road with bump, pothole and hump, {speed} km/h",
        "speed_kmh": speed,
        "road": {
            "length_m": start + 5.0,
            "roughness": {"iso_class": iso_class, "seed": int(rng.integers(1000))},
            "features": placed,
        },
    }


def sample(kind: str, count: int, rng: np.random.Generator) -> list[dict[str, float]]:
    """Sizes and speed of `count` features: m to the centimetre, whole km/h."""
    ranges = RANGES[kind]
    low, high = np.array(list(ranges.values())).T
    points = qmc.scale(qmc.LatinHypercube(len(ranges), rng=rng).random(count), low, high)
    return [
        {
            name: int(value) if name == "speed_kmh" else round(float(value), 2)
            for name, value in zip(ranges, point, strict=True)
        }
        for point in np.round(points, 2)
    ]


def place(kind: str, sizes: dict[str, float], start_m: float, rng: np.random.Generator) -> dict[str, Any]:
    """Feature entry for a scenario file; potholes lie on the right track."""
    feature = {"kind": kind, "start_m": start_m, **sizes}
    if kind == "pothole":
        return feature | {"y_m": -0.75, "seed": int(rng.integers(1000))}
    return feature | {"paint": "yellow_black" if kind == "half_sine_bump" else "white_stripes"}


def title(feature: dict[str, Any], speed_kmh: float) -> str:
    """Title of an event, for tables and videos."""
    size = 100 * feature.get("height_m", feature.get("depth_m", 0.0))
    name = feature["kind"].replace("_", " ").replace("half sine ", "").capitalize()
    return f"{name} {size:.0f} cm x {feature['length_m']:.2f} m, {speed_kmh:.0f} km/h"


def write(name: str, what: str, events: list[dict[str, Any]]) -> None:
    named = [event | {"name": f"{name}_{event['name']}"} for event in events]
    lines = [yaml.safe_dump(event, default_flow_style=True, width=10_000, sort_keys=False) for event in named]
    head = f"# {what}\n# Drawn by: python -m benchmarks.draw_events\n"
    write_text(FOLDER / f"{name}.yaml", head + "".join(f"- {line}" for line in lines))
    print(f"{FOLDER / name}.yaml: {len(events)} events")


if __name__ == "__main__":
    main()
