"""Closed-loop tests: under every fault the supervised MPC is at most 2 % worse than its fallback law."""

from functools import cache

import pytest

from foreride.scenarios.cases import Case
from foreride.scenarios.definition.loading import load
from foreride.scenarios.simulation.simulate import Run, simulate

TOLERANCE = 1.02
EVENTS = {
    "bump_8x40_30": ["road.length_m=30", "road.features.0.start_m=12"],
    "pothole_60x8_40": ["road.length_m=32", "road.features.0.start_m=12"],
}
WHILE = "start_s: 0.6, duration_s: 1.2"
SENSORS = {
    "rattle stuck": f"{{kind: sensor, channel: rattle_m, mode: stuck, {WHILE}}}",
    "rattle silent": f"{{kind: sensor, channel: rattle_m, mode: silent, {WHILE}}}",
    "body accelerometer stuck": f"{{kind: sensor, channel: body_acc, mode: stuck, {WHILE}}}",
    "wheel accelerometer silent": f"{{kind: sensor, channel: wheel_acc, mode: silent, {WHILE}}}",
    "all silent": f"{{kind: sensor, channel: all, mode: silent, {WHILE}}}",
    "all stuck": f"{{kind: sensor, channel: all, mode: stuck, {WHILE}}}",
    "speed silent": f"{{kind: sensor, channel: speed_m_s, mode: silent, {WHILE}}}",
}
ANSWERS = {
    "all late": "{kind: late_answers, start_s: 0, duration_s: 100}",
    "late while over the obstacle": f"{{kind: late_answers, {WHILE}}}",
    "some late": "{kind: late_answers, start_s: 0, duration_s: 100, probability: 0.3}",
}
PREVIEWS = {
    "frozen": f"{{kind: preview, mode: frozen, {WHILE}}}",
    "absurd": f"{{kind: preview, mode: absurd, {WHILE}}}",
}


@cache
def run(event: str, controller: str, fault: str) -> Run:
    overrides = [*EVENTS[event], "vehicle.model=quarter", f"faults=[{fault}]"]
    perception = "oracle" if controller == "mpc_preview" else "none"
    return simulate(Case(load(event, overrides), controller, perception, 0))


def objective(event: str, controller: str, fault: str = "") -> float:
    return run(event, controller, fault).metrics["objective"]


@pytest.mark.parametrize("event", EVENTS)
@pytest.mark.parametrize("fault", [*SENSORS.values(), *ANSWERS.values()], ids=[*SENSORS, *ANSWERS])
def test_never_worse_than_the_reactive_law(event: str, fault: str) -> None:
    assert objective(event, "mpc_preview", fault) <= TOLERANCE * objective(event, "skyhook", fault)


@pytest.mark.parametrize("event", EVENTS)
@pytest.mark.parametrize("fault", PREVIEWS.values(), ids=PREVIEWS)
def test_without_a_preview_to_believe_it_is_the_reactive_mpc(event: str, fault: str) -> None:
    assert objective(event, "mpc_preview", fault) <= TOLERANCE * objective(event, "mpc_reactive")


@pytest.mark.parametrize(
    ("fault", "reason"),
    [
        (SENSORS["rattle stuck"], "rattle_m_0 stuck"),
        (SENSORS["all silent"], "all sensors silent"),
        (ANSWERS["late while over the obstacle"], "late answer"),
        (PREVIEWS["absurd"], "absurd preview"),
        (PREVIEWS["frozen"], "stale preview"),
    ],
)
def test_fallbacks_are_counted_and_logged_by_name_while_the_fault_lasts(fault: str, reason: str) -> None:
    found = run("bump_8x40_30", "mpc_preview", fault)
    logged = [event for event in found.events if event["event"] == "fallback"]
    assert found.solver["reasons"] == {reason: len(logged)}
    assert all(event["reason"] == reason and 0.6 <= event["time_s"] < 1.8 for event in logged)
    assert len(logged) >= 0.9 * 1.2 * 200


def test_a_drive_of_only_late_answers_is_one_with_the_reactive_law() -> None:
    late, law = (
        run("pothole_60x8_40", "mpc_preview", ANSWERS["all late"]),
        run("pothole_60x8_40", "skyhook", ""),
    )
    assert late.metrics == law.metrics
