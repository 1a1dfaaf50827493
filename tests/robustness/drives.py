"""Short drives with the most extreme values that scenario files may hold.

`python -m tests.robustness.drives`: each gives finite metrics or raises InputError.
"""

import argparse
import copy
import math
import random
import sys
import time
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

from foreride.files.errors import InputError
from foreride.files.reading import strict
from foreride.scenarios.cases import Case
from foreride.scenarios.commands.drive.bound import ACTUATORS
from foreride.scenarios.definition.loading import load
from foreride.scenarios.definition.schema import Scenario
from foreride.scenarios.simulation.simulate import simulate
from tests.fuzz.trial import ground_position

LONGEST_TICKS = 1500
CARS = ("quarter", "half", "full", "suv", "van", "heavy_van", "compact_car")
PERCEPTIONS = ("none", "oracle", "oracle", "boxes", "boxes")
CONTROLLERS = (
    "passive", "fixed", "skyhook", "skyhook2", "groundhook", "hybrid", "add", "sh_add", "pdd", "lqr_clipped",
    "mpc_reactive", "mpc_wheelbase", "mpc_preview",
)  # fmt: skip
SHORT = (
    "road.length_m=14", "start_m=9.5", "speed_kmh=40", "road.features.0.start_m=11.8",
    "road.roughness.iso_class=B", "camera.latency_s=0.02", "camera.rate_hz=50",
)  # fmt: skip
Path = tuple[str | int, ...]


@dataclass(frozen=True)
class Trial:
    """A base scenario, changed at some places, and who drives it. told: what went wrong, if anything."""

    car: str
    actuator: str
    changes: tuple[tuple[Path, float], ...]
    controller: str
    perception: str
    told: str = ""

    def __str__(self) -> str:
        changes = ", ".join(f"{'.'.join(map(str, path))}={value!r}" for path, value in self.changes)
        return f"{self.car} {self.actuator} {self.controller} {self.perception}: {changes}: {self.told}"


@cache
def base(car: str, actuator: str) -> dict[str, Any]:
    """A drive of 0.2 s over the beginning of a bump, every field with its value."""
    scenario = load("bump_8x40_30", [f"vehicle.model={car}", *SHORT])
    parameters = replace(scenario.vehicle.parameters, actuator=ACTUATORS[actuator])
    return replace(scenario, vehicle=replace(scenario.vehicle, parameters=parameters)).mapping


def numbers(value: Any, path: Path = ()) -> Iterator[Path]:
    """Places of all numbers within nested mappings and lists."""
    if isinstance(value, dict | list | tuple):
        for key, inner in value.items() if isinstance(value, dict) else enumerate(value):
            yield from numbers(inner, (*path, key))
    elif isinstance(value, int | float) and not isinstance(value, bool):
        yield path


def changed(mapping: dict[str, Any], changes: tuple[tuple[Path, float], ...]) -> Scenario:
    """The scenario of a mapping with other values at some places; InputError where it is not allowed."""
    mapping = copy.deepcopy(mapping)
    for path, value in changes:
        holder: Any = mapping
        for key in path[:-1]:
            if isinstance(holder[key], tuple):
                holder[key] = list(holder[key])
            holder = holder[key]
        holder[path[-1]] = value
    found = strict.structure(Scenario, mapping, "fuzz")
    assert isinstance(found, Scenario)
    return found


def value_at(mapping: dict[str, Any], path: Path) -> float:
    """The number at a place."""
    found: Any = mapping
    for key in path:
        found = found[key]
    return float(found)


@cache
def edge(car: str, actuator: str, path: Path, up: bool) -> float:
    """The greatest or least value that a field may have, the others as they are."""
    mapping = base(car, actuator)
    whole = isinstance(_raw(mapping, path), int)

    def allowed(value: float) -> bool:
        try:
            changed(mapping, ((path, int(value) if whole else value),))
        except InputError:
            return False
        return True

    good = value_at(mapping, path)
    for bad in (1e300, 1e12, 1e9) if up else (-1e300, -1e9, 0.0):
        if whole and abs(bad) > 1e15:
            continue
        if allowed(bad):
            return bad
    bad = 1e9 if up else 0.0 if good > 0 else -1e9
    for _ in range(50):
        middle = math.copysign(math.sqrt(good * bad), good) if good * bad > 0 else (good + bad) / 2
        if whole:
            middle = float(round(middle))
        if middle in (good, bad):
            break
        good, bad = (middle, bad) if allowed(middle) else (good, middle)
    return int(good) if whole else good


def _raw(mapping: Any, path: Path) -> Any:
    for key in path:
        mapping = mapping[key]
    return mapping


def trial(rng: random.Random, path: Path | None = None, up: bool = True) -> Trial:
    """A drive with one to four extreme values, or with one at the place given."""
    car, actuator = rng.choice(CARS), rng.choice(tuple(ACTUATORS))
    places = list(numbers(base(car, actuator)))
    wanted = [(path, up)] if path in places and path is not None else []
    while len(wanted) < 1 or (path is None and rng.random() < 0.5 and len(wanted) < 4):
        wanted.append((rng.choice(places), rng.random() < 0.5))
    changes = tuple((place, edge(car, actuator, place, high)) for place, high in wanted)
    quick = rng.random() < 0.75
    controller = rng.choice(CONTROLLERS[:10] if quick else CONTROLLERS)
    sees = controller == "mpc_preview"
    return driven(Trial(car, actuator, changes, controller, rng.choice(PERCEPTIONS) if sees else "none"))


def driven(one: Trial) -> Trial:
    """The trial with what was wrong when it was driven; `refused` or `long` where it was not."""
    try:
        scenario = changed(base(one.car, one.actuator), one.changes)
        if scenario.ticks > LONGEST_TICKS:
            return replace(one, told="long")
        metrics = simulate(Case(scenario, one.controller, one.perception, scenario.seed)).metrics
    except InputError:
        return replace(one, told="refused")
    except Exception as error:
        return replace(one, told=f"{type(error).__name__} at {ground_position(error)}: {error}"[:300])
    bad = [name for name, value in metrics.items() if not math.isfinite(value)]
    return replace(one, told=f"not finite: {', '.join(bad)}" if bad else "")


def every_edge(car: str = "half") -> Iterator[tuple[Path, bool]]:
    """Both ends of every number of a scenario."""
    for path in numbers(base(car, "none")):
        yield path, False
        yield path, True


def main() -> int:
    """Drive for so long, print what went wrong and figures; 1 where anything did."""
    parser = argparse.ArgumentParser(prog="python -m tests.robustness.drives", description=__doc__)
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()
    rng, end = random.Random(arguments.seed), time.monotonic() + 60 * arguments.minutes
    edges, ends, seen = list(every_edge()), Counter[str](), set[str]()
    rng.shuffle(edges)
    while time.monotonic() < end:
        one = trial(rng, *edges.pop()) if edges else trial(rng)
        kind = one.told if one.told in ("", "refused", "long") else "wrong"
        ends[kind or "well"] += 1
        if kind == "wrong" and (key := one.told.split(":")[0]) not in seen:
            seen.add(key)
            print(one, flush=True)
    print(f"{sum(ends.values())} drives: {dict(ends)}; single edges left: {len(edges)}")
    return int(bool(ends["wrong"]))


if __name__ == "__main__":
    sys.exit(main())
