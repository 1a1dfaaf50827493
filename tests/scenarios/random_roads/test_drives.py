"""Drives over random roads: lines of a table, and rows that later calls reuse only if nothing changed."""

import pytest

from foreride.files.errors import InputError
from foreride.scenarios.definition.overrides import parse_override
from foreride.scenarios.random_roads.drives import Drive, Line, lines, missing, simulated

PLAIN = {"": ()}


def test_only_controllers_with_preview_run_with_each_perception() -> None:
    names = [line.name for line in lines(["passive", "mpc_preview"], ["oracle", "boxes"])]
    assert names == ["passive", "mpc_preview@oracle", "mpc_preview@boxes"]


def test_a_row_is_reused_for_the_same_settings_and_refused_for_others() -> None:
    drives = [Drive(event, 0, Line("passive", "none")) for event in (0, 1)]
    (row,) = simulated(drives[:1], PLAIN, jobs=1)
    assert Drive.of(row) == drives[0]
    assert row["metrics"]["objective"] > 0.0
    assert missing(drives, [row], PLAIN) == drives[1:]
    with pytest.raises(InputError, match="event 0, passive was driven with other settings"):
        missing(drives, [row], {"": [parse_override("speed_kmh=20")]})
