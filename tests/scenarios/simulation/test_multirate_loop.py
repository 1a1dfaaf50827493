"""Tests of fallbacks in the loop: counted and logged; a failed solver never stops a drive."""

from pathlib import Path

import pytest

import foreride.controller.mpc.program as program
from foreride.controller.mpc.qp import Solution, solve_box
from foreride.controller.supervision.preview_gate import INCONSISTENT
from foreride.scenarios.cases import Case
from foreride.scenarios.definition.loading import load
from foreride.scenarios.simulation.simulate import simulate


def test_fallbacks_are_counted_logged_and_survived(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    calls = []

    def failing(*problem: object) -> Solution:
        calls.append(problem)
        good = solve_box(*problem)  # type: ignore[arg-type]
        return Solution(good.x, "iteration limit") if 20 <= len(calls) < 40 else good

    monkeypatch.setattr(program, "solve_stages", lambda *_: None)
    monkeypatch.setattr(program, "solve_box", failing)
    overrides = ["vehicle.model=quarter", "road.length_m=22", "road.features.0.start_m=10"]
    run = simulate(Case(load("bump_8x40_30", overrides), "mpc_preview", "oracle", 0))
    logged = [event for event in run.events if event["event"] == "fallback"]
    assert run.solver["fallbacks"] == len(logged) == 20
    assert run.solver["reasons"] == {"iteration limit": 20}
    assert {event["reason"] for event in logged} == {"iteration limit"}
    assert run.signals["damping_0"].max() <= 4500 + 1e-6


def test_a_camera_mounted_lower_than_believed_costs_no_more_than_none() -> None:
    """Without the gate J is a quarter above that of the reactive controller: the hump comes too late."""
    overrides = ["vehicle.model=quarter", "start_m=14", "camera.height_m=0.3", "camera.height_sigma_m=0.2"]
    scenario = load("hump_flat_30", overrides)
    reactive = simulate(Case(scenario, "mpc_reactive", "none", 0))
    preview = simulate(Case(scenario, "mpc_preview", "boxes", 0))
    assert preview.metrics["objective"] <= 1.05 * reactive.metrics["objective"]
    assert preview.solver["reasons"][INCONSISTENT] > 100
    assert INCONSISTENT in {event.get("reason") for event in preview.events}
