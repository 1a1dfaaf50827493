"""Drives of the speed study: each policy on an event, and a constant speed that takes as long."""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from foreride.comfort.weighting import weight
from foreride.scenarios.bound.simulate_case import simulate_case
from foreride.scenarios.cases import Case
from foreride.scenarios.definition.clock import TICKS_PER_SECOND
from foreride.scenarios.definition.overrides import Override, parse_override
from foreride.scenarios.random_roads.events import event_scenario

CRUISE = "cruising speed"
REGAIN_M = 30.0
"""Length added to the road of an event, over which the cruising speed is regained."""
_REACTIVE = "kind: reactive, max_deceleration_m_s2: 1.5"
"""Reactive braking at 3 m/s² costs half as much again in Wd, and saves no more in Wk."""
POLICIES: dict[str, str] = {
    **{f"reactive {level:g}": f"{_REACTIVE}, comfortable_m_s2: {level:g}" for level in (0.6, 0.3)},
    **{f"preview {weight:g}": f"kind: preview, time_weight: {weight:g}" for weight in (0.4, 0.2, 0.1, 0.05)},
}
"""Speed planner of each policy, by its name: the planner's kind and the setting that trades time for ride."""

Metrics = dict[str, float]


class Group(NamedTuple):
    """All drives of one controller with one perception on an event and seed."""

    event: int
    seed: int
    controller: str
    perception: str


def driven_group(group: Group, overrides: Sequence[Override], policies: Sequence[str]) -> dict[str, Any]:
    """Row of a group: its metrics by policy; `equal time` holds those of the constant speeds."""
    cruise = simulated(group, [*overrides, *_event_overrides(group)])
    planned, equal = {CRUISE: cruise}, {}
    for name in policies:
        planner = parse_override(f"speed_planner={{{POLICIES[name]}}}")
        planned[name] = simulated(group, [*overrides, *_event_overrides(group), planner])
        slower = cruise["speed_kmh"] * cruise["trip_s"] / planned[name]["trip_s"]
        constant = parse_override(f"speed_kmh={max(slower, 1.0):.6f}")
        equal[name] = simulated(group, [*overrides, *_event_overrides(group), constant])
    return {**group._asdict(), "policies": planned, "equal time": equal}


def _event_overrides(group: Group) -> list[Override]:
    """Cruise at the speed with which the event meets its obstacle, and a longer road."""
    event = event_scenario(group.event)
    cruise_kmh = event.speed[-1].kmh if event.speed else event.speed_kmh
    texts = f"speed_kmh={cruise_kmh:g}", "speed=[]", f"road.length_m={event.road.length_m + REGAIN_M:g}"
    return [parse_override(text) for text in texts]


def simulated(group: Group, overrides: Sequence[Override]) -> Metrics:
    """Metrics of one drive.

    wk2, x2, load2: integrals over the drive of the squares of the Wk-weighted vertical acceleration (mean of
    the seats), the Wd-weighted longitudinal acceleration, and the relative tyre load; m²/s³, m²/s³, s.
    """
    scenario = event_scenario(group.event, list(overrides))
    run = simulate_case(Case(scenario, group.controller, group.perception, group.seed))
    signals, metrics = run.signals, run.metrics
    trip_s = float(signals["time_s"][-1])
    forward = signals["forward_acc"]
    return {
        "trip_s": trip_s,
        "speed_kmh": scenario.speed_kmh,
        "wk2": metrics["wk_rms"] ** 2 * trip_s,
        "x2": float(np.mean(weight(forward, TICKS_PER_SECOND, "Wd") ** 2)) * trip_s,
        "load2": metrics["tyre_load_rms"] ** 2 * trip_s,
        "vdv": metrics["vdv"],
        "least_kmh": float(signals["speed_m_s"].min()) * 3.6,
        "deceleration": max(0.0, -float(forward.min())),
    }


def key_of(row: Mapping[str, Any]) -> Group:
    """Group of a row."""
    return Group(row["event"], row["seed"], row["controller"], row["perception"])
