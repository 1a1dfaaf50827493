"""Tests of the engine that a scenario names."""

import pytest

from foreride.files.errors import InputError
from foreride.scenarios.cases import Case
from foreride.scenarios.definition.loading import load
from foreride.scenarios.simulation.simulate import simulate

SHORT = {"road.length_m": 50.0, "vehicle.model": "half"}


@pytest.mark.parametrize("controller", ["passive", "skyhook"])
def test_metrics_are_those_of_mujoco_and_repeat_bit_for_bit(controller: str) -> None:
    compiled = Case(load("bump_8x40_30", SHORT | {"engine": "compiled"}), controller, "none", 0)
    reference = simulate(Case(load("bump_8x40_30", SHORT), controller, "none", 0)).metrics
    found = simulate(compiled).metrics
    assert found == pytest.approx(reference, rel=1e-8, abs=1e-9)
    assert found == simulate(compiled).metrics


def test_dampers_that_are_not_ideal_are_refused() -> None:
    valve = {"engine": "compiled", "vehicle.parameters.damper": {"kind": "valve"}}
    with pytest.raises(InputError, match="engine compiled needs ideal dampers, got valve"):
        load("bump_8x40_30", valve)
