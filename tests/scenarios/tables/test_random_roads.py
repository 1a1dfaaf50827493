"""The table of random roads: which lines it prints, and that a second call drives only what is missing."""

from pathlib import Path

import numpy as np
import pytest

from foreride.files.errors import InputError
from foreride.scenarios.random_roads.drives import Drive, Line
from foreride.scenarios.random_roads.results import Results
from foreride.scenarios.tables import random_roads

LEVELS = {"passive": 1.0, "mpc_reactive": 0.6, "mpc_wheelbase": 0.5, "oracle": 0.4, "boxes": 0.45}


def row(drive: Drive) -> dict:
    line = drive.line
    level = LEVELS.get(line.perception, LEVELS.get(line.controller, 0.7))
    metrics = dict.fromkeys(("objective", "wk_rms", "tyre_load_rms", "rattle_rms"), level)
    return {
        "event": drive.event,
        "seed": drive.seed,
        **line._asdict(),
        "scenario_hash": "",
        "metrics": metrics,
    }


def test_a_second_call_drives_only_what_is_missing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    driven: list[Drive] = []

    def simulated(drives: list[Drive], *_: object) -> list[dict]:
        driven.extend(drives)
        return [row(drive) for drive in drives]

    monkeypatch.setattr(random_roads, "simulated", simulated)
    monkeypatch.setattr("foreride.scenarios.random_roads.drives.scenario_hash", lambda scenario: "")
    path = tmp_path / "rows.jsonl"
    random_roads.main(["--first", "7", "--events", "2", "--json", str(path)])
    assert len(driven) == 2 * 5
    text = capsys.readouterr().out
    assert "| mpc_preview@boxes | 0.450 |" in text
    assert "| mpc_preview@boxes | 75% | 0 of 2 | 50% | 0 of 2 | -10.0% in 7" in text
    driven.clear()
    random_roads.main(["--first", "7", "--events", "3", "--json", str(path)])
    assert {drive.event for drive in driven} == {9}


def test_what_exact_obstacles_alone_give_is_a_limit_of_its_own() -> None:
    values = {("passive", "none"): 1.0, ("mpc_reactive", "none"): 0.6, ("mpc_preview", "oracle"): 0.4}
    values |= {("mpc_preview", "obstacles"): 0.5, ("mpc_preview", "boxes"): 0.55}
    of_line = {Line(*name): {"objective": np.full((2, 1), value)} for name, value in values.items()}
    head, _, *kept = random_roads.kept_table(Results((0, 1), of_line))
    assert head.startswith(
        "| preview | gain kept over mpc_reactive | of exact obstacles kept over mpc_reactive"
    )
    assert [row.split(" | ")[1:3] for row in kept] == [["100%", "200%"], ["50%", "100%"], ["25%", "50%"]]


def test_laws_are_also_told_as_the_best_of_each_event() -> None:
    passive, sky, add = (Line(name, "none") for name in ("passive", "skyhook", "add"))
    values = {passive: [1.0, 1.0], sky: [0.6, 0.9], add: [0.8, 0.7]}
    metrics = ("objective", "wk_rms", "tyre_load_rms", "rattle_rms")
    of_line = {line: dict.fromkeys(metrics, np.array(value)[:, None]) for line, value in values.items()}
    last = random_roads.line_table(Results((0, 1), of_line))[-1]
    assert last.startswith("| best of 2 laws, event by event | 0.650 |")


def test_events_are_written_as_scenario_files(tmp_path: Path) -> None:
    random_roads.main(["--first", "1000", "--events", "2", "--write-events", str(tmp_path)])
    assert sorted(path.name for path in tmp_path.iterdir()) == ["random_1000.yaml", "random_1001.yaml"]


@pytest.mark.parametrize("options", [["--events", "0"], ["--first", "-1"], ["--controllers", "nobody"]])
def test_bad_options_are_refused(options: list[str]) -> None:
    with pytest.raises(InputError, match=r"must be"):
        random_roads.main(options)
