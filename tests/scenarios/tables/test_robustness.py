"""The robustness table: conditions are valid scenarios, each compared with its own passive car."""

import numpy as np
import pytest

from foreride.scenarios.random_roads.conditions import CONDITIONS, NOMINAL
from foreride.scenarios.random_roads.drives import Line
from foreride.scenarios.random_roads.events import event_scenario
from foreride.scenarios.random_roads.results import Results
from foreride.scenarios.tables.robustness import robustness_table


@pytest.mark.parametrize("name", CONDITIONS)
def test_each_condition_differs_from_the_nominal_one_in_car_or_knowledge(name: str) -> None:
    scenario, nominal = event_scenario(3, CONDITIONS[name]), event_scenario(3)
    assert (scenario.mapping == nominal.mapping) == (name == NOMINAL)
    if name.endswith("known") and name != NOMINAL:
        assert scenario.true_car == scenario.vehicle.parameters
        assert scenario.plant == nominal.plant


def test_every_condition_is_relative_to_its_own_passive_car() -> None:
    levels = {"passive": 1.0, "mpc_reactive": 0.6, "mpc_preview": 0.5}
    of_line = {
        Line(name, "oracle" if name == "mpc_preview" else "none", condition): {
            "objective": np.full((2, 1), level * scale)
        }
        for condition, scale in ((NOMINAL, 1.0), ("delay 15 ms", 3.0))
        for name, level in levels.items()
    }
    lines = robustness_table(Results((0, 1), of_line), [NOMINAL, "delay 15 ms"])
    assert lines[0] == "| condition | mpc_reactive | mpc_preview@oracle | mpc_preview@oracle / mpc_reactive |"
    assert lines[2:] == [f"| {name} | 0.600 | 0.500 | 0.833 |" for name in (NOMINAL, "delay 15 ms")]
