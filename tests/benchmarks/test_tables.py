"""The tables of benchmarks: pieces are joined, and a broken solver is broken when it should be."""

import json
from pathlib import Path

import pytest

from benchmarks.tables.faults import SOLVER, WINDOW_S, broken_solver, start_s
from benchmarks.tables.runs import Variant, run_all
from scenarios.cases import Case
from scenarios.closed_loop import simulate
from scenarios.loading import load
from scenarios.schema import Scenario

SHORT = """
title: One bump
speed_kmh: 40
vehicle: {model: quarter}
road: {length_m: 25, features: [{kind: half_sine_bump, start_m: 8, length_m: 0.5, height_m: 0.04}]}
"""


@pytest.fixture
def short(tmp_path: Path) -> Scenario:
    path = tmp_path / "short.yaml"
    path.write_text(SHORT)
    return load(str(path))


@pytest.mark.parametrize(
    ("name", "told"), [("solver fails", "iteration limit"), ("solver answers NaN", "not finite")]
)
def test_a_broken_solver_is_noticed_in_the_window_and_nowhere_else(
    short: Scenario, name: str, told: str
) -> None:
    with broken_solver(SOLVER[name], short):
        run = simulate(Case(short, "mpc_reactive", "none", 0))
    begin = start_s(short)
    assert run.solver["reasons"] == {told: round(WINDOW_S * short.control.rate_hz)}
    times = [event["time_s"] for event in run.events if event["event"] == "fallback"]
    assert begin <= min(times) < max(times) < begin + WINDOW_S
    assert simulate(Case(short, "mpc_reactive", "none", 0)).solver["fallbacks"] == 0


def test_rows_of_pieces_are_not_driven_anew(short: Scenario, tmp_path: Path) -> None:
    row = {"vehicle": "quarter", "scenario": short.name, "seed": 4, "metrics": {"objective": -1.0}}
    piece = tmp_path / "piece.json"
    piece.write_text(json.dumps({"variants": {"soft": [row]}}))
    done = run_all([Variant("soft", "passive", "none", [short])], [3, 4], [piece])
    (driven,), (read,) = done["soft"]
    assert read == row
    assert driven["metrics"]["objective"] > 0.0
