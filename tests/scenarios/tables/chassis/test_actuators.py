"""The table of actuators: valid suspensions, values relative to passive, power of those that have any."""

import numpy as np
import pytest

from foreride.scenarios.random_roads.drives import Line
from foreride.scenarios.random_roads.events import event_scenario
from foreride.scenarios.random_roads.results import Results
from foreride.scenarios.tables.chassis.actuators import SEMI_ACTIVE, SUSPENSIONS, actuator_table


@pytest.mark.parametrize("name", SUSPENSIONS)
def test_each_suspension_is_a_valid_car(name: str) -> None:
    actuator = event_scenario(0, SUSPENSIONS[name]).vehicle.parameters.actuator
    assert (actuator is None) == (name == SEMI_ACTIVE)
    if actuator is not None:
        bandwidth = float(name.split(",")[1].split()[0])
        assert 1.0 / (2.0 * np.pi * actuator.lag_s) == pytest.approx(bandwidth, rel=0.02)


def test_rows_are_relative_to_passive_and_show_the_power() -> None:
    active = "slow-active, 1.6 Hz, 3 kN"
    ride = ("objective", "wk_rms", "tyre_load_rms", "rattle_rms")
    of_line = {}
    for condition in (SEMI_ACTIVE, active):
        of_line[Line("passive", "none", condition)] = {name: np.full((2, 1), 2.0) for name in ride}
        of_line[Line("mpc_preview", "oracle", condition)] = {name: np.full((2, 1), 1.0) for name in ride}
    of_line[Line("mpc_preview", "oracle", active)] |= {
        "actuator_power": np.full((2, 1), 120.0),
        "actuator_power_peak": np.full((2, 1), 900.0),
    }
    assert actuator_table(Results((0, 1), of_line))[2:] == [
        f"| {SEMI_ACTIVE} | mpc_preview@oracle | 0.500 | 0.500 | 0.500 | 0.500 | 0 | 0 |",
        f"| {active} | mpc_preview@oracle | 0.500 | 0.500 | 0.500 | 0.500 | 120 | 900 |",
    ]
