"""`foreride front`: the table and the figure of fronts."""

from pathlib import Path

import numpy as np
import pytest

from foreride.scenarios import cli
from foreride.scenarios.tables import random_roads
from foreride.scenarios.tables.front import front_table


def test_a_front_is_told_point_by_point_with_what_it_dominates() -> None:
    values = np.array([[0.5, 0.8, 0.5], [0.8, 0.5, 0.5], [0.9, 0.9, 0.9]])
    lines = front_table({"mpc_preview@oracle": (["control.settings.mpc.rho=1", "b", "c"], values)})
    assert lines[2] == "| mpc_preview@oracle | mpc.rho=1 | 0.500 | 0.800 | 0.500 | 0.302 | 0.181 |"
    assert lines[4].startswith("|  | c (dominated) | 0.900")


def test_the_command_draws_the_fronts_that_it_prints(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def simulated(drives: list, *_: object) -> list[dict]:
        levels = {"wk_rms": 0.5, "tyre_load_rms": 0.8, "rattle_rms": 0.9}
        return [
            {
                "event": drive.event, "seed": drive.seed, **drive.line._asdict(), "scenario_hash": "",
                "metrics": dict.fromkeys(levels, 1.0) if drive.line.controller == "passive" else levels,
            }
            for drive in drives
        ]  # fmt: skip

    monkeypatch.setattr(random_roads, "simulated", simulated)
    plot = tmp_path / "front.png"
    options = ["--events", "2", "--controllers", "skyhook,mpc_preview", "--plot", str(plot)]
    assert cli.main(["front", *options]) == 0
    assert plot.read_bytes().startswith(b"\x89PNG")
    row = "| mpc_preview@oracle | mpc.rho=0.3 | 0.500 | 0.800 | 0.900 | 0.216 | 0.060 |"
    assert row in capsys.readouterr().out
