"""Closed-loop tests of slow-active actuators in parallel with the dampers, for which preview is essential."""

import pytest

from foreride.scenarios.cases import Case
from foreride.scenarios.definition.loading import load
from foreride.scenarios.simulation.simulate import Run, simulate

CAR = "vehicle={model: quarter, parameters: {actuator: {kind: slow_active}}}"


def drive(event: str, controller: str) -> Run:
    """Simulate a stretch of road around the obstacle, with exact states."""
    case = load(event, [CAR, "observer=truth", "start_m=35"])
    return simulate(Case(case, controller, "oracle" if controller == "mpc_preview" else "none", 0))


@pytest.mark.parametrize("event", ["bump_8x40_30", "pothole_60x8_40"])
def test_preview_saves_forty_per_cent_over_the_same_actuator_without_it(event: str) -> None:
    reactive, preview = drive(event, "mpc_reactive"), drive(event, "mpc_preview")
    assert preview.metrics["objective"] < 0.6 * reactive.metrics["objective"]
    assert preview.solver["fallbacks"] == reactive.solver["fallbacks"] == 0
    force = abs(preview.signals["actuator_force_0"])
    assert 500.0 < force.max() <= 3000.0
    told = [event for event in preview.events if event["event"] == "constraints"]
    assert {name for event in told for name in event["active"]} == set(preview.solver["active"])
    assert "force" in preview.solver["active"]
