"""The table of sensors: a line for each, and what it keeps of the gain of the true road."""

import numpy as np
import pytest

from foreride.files.errors import InputError
from foreride.scenarios.random_roads.drives import Line
from foreride.scenarios.random_roads.results import Results
from foreride.scenarios.tables import sensors

LEVELS = {
    Line("passive", "none"): [1.0, 1.0, 1.0],
    Line("mpc_reactive", "none"): [0.6, 0.7, 0.8],
    Line("mpc_preview", "oracle"): [0.4, 0.5, 0.6],
    Line("mpc_preview", "lidar_64"): [0.45, 0.55, 0.9],
}


def test_each_sensor_has_a_line() -> None:
    metrics = ("objective", "wk_rms")
    of_line = {line: dict.fromkeys(metrics, np.array(values)[:, None]) for line, values in LEVELS.items()}
    head, _, reactive, oracle, lidar = sensors.sensor_table(Results((1, 2, 3), of_line))
    assert "gain kept over mpc_reactive" in head
    assert reactive.startswith("| none (`mpc_reactive`) | 0.700 ")
    assert oracle.startswith("| true road | 0.500 ")
    assert "| 100% [100%, 100%] | 0 of 3 |" in oracle
    assert lidar.startswith("| LiDAR with 64 beams | 0.633 ")
    assert lidar.endswith("| 1 of 3 |")
    assert "| 33% [" in lidar


def test_an_unknown_sensor_is_refused() -> None:
    with pytest.raises(InputError, match="radar"):
        sensors.main(["--perceptions", "radar"])
