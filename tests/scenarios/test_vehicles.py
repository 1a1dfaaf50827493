import numpy as np
import pytest

from foreride.scenarios.cases import Case
from foreride.scenarios.definition.loading import load
from foreride.scenarios.simulation.simulate import Run, simulate


def drive(vehicle: str, controller: str, *overrides: str) -> Run:
    """Simulate a short stretch of road with the narrow bump."""
    fields = [f"vehicle={vehicle}", "start_m=34", "road.length_m=48", *overrides]
    return simulate(Case(load("bump_8x40_30", fields), controller, "none", 0))


def test_a_full_car_feels_the_bump_as_the_half_car_does() -> None:
    half, full = (drive(f"{{model: {model}}}", "passive") for model in ("half", "full"))
    for name in ("wk_rms", "tyre_load_rms", "rattle_peak", "objective"):
        assert full.metrics[name] == pytest.approx(half.metrics[name], rel=1e-9)


@pytest.mark.parametrize("kind", ["valve", "mr_tanh", "mr_bouc_wen"])
def test_every_damper_runs_in_the_loop_and_is_audited(kind: str) -> None:
    run = drive(f"{{model: quarter, parameters: {{damper: {{kind: {kind}}}}}}}", "mpc_reactive")
    assert run.solver["fallbacks"] == 0
    assert run.metrics["damping_outside"] == 0.0
    assert run.metrics["damper_produced"] < 0.01 * run.metrics["damper_energy"]


def test_braking_before_the_bump_pitches_the_car_and_slows_it() -> None:
    run = drive("{model: half}", "passive", "speed=[{at_m: 36, kmh: 30}, {at_m: 40, kmh: 15}]")
    signals = run.signals
    braking = (signals["x_m"] > 36.5) & (signals["x_m"] < 39.5)
    assert signals["forward_acc"][braking] == pytest.approx(-(8.333**2 - 4.167**2) / 8.0, rel=1e-3)
    assert signals["pitch_rad"][braking].max() > 0.01
    assert signals["speed_m_s"][-1] == pytest.approx(15 / 3.6)
    assert np.diff(signals["x_m"]).min() > 0.0


def test_an_actuator_that_nobody_asks_changes_nothing() -> None:
    plain = drive("{model: quarter}", "mpc_reactive")
    beside = drive("{model: quarter, parameters: {actuator: {kind: slow_active}}}", "passive")
    alone = drive("{model: quarter}", "passive")
    assert beside.metrics["objective"] == pytest.approx(alone.metrics["objective"], rel=1e-9)
    assert beside.metrics["actuator_energy"] == 0.0
    assert plain.metrics["objective"] < alone.metrics["objective"]
