"""Tests of the table commands: merging of partial results, and fault injection into the solver."""

import json
from dataclasses import replace
from pathlib import Path

import pytest

from foreride.files.errors import InputError
from foreride.scenarios import cli
from foreride.scenarios.cases import Case
from foreride.scenarios.commands.table import TABLES
from foreride.scenarios.definition.loading import load
from foreride.scenarios.definition.schema import Scenario
from foreride.scenarios.runs.write import to_json
from foreride.scenarios.simulation.simulate import simulate
from foreride.scenarios.tables.faults import SOLVER, WINDOW_S, broken_solver, names_for, start_s, variants
from foreride.scenarios.tables.runs import Variant, run_all, settings, write

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


def test_a_solver_asked_twice_a_step_is_broken_for_the_whole_window(tmp_path: Path) -> None:
    (tmp_path / "short.yaml").write_text(SHORT)
    car = "vehicle={model: half, parameters: {actuator: {kind: slow_active}}}"
    scenario = load(str(tmp_path / "short.yaml"), [car])
    asked = []

    def fails(found: tuple) -> tuple:
        asked.append(found)
        return SOLVER["solver fails"](found)

    with broken_solver(fails, scenario):
        run = simulate(Case(scenario, "mpc_reactive", "none", 0))
    periods = round(WINDOW_S * scenario.control.rate_hz)
    assert run.solver["reasons"] == {"iteration limit": periods}
    assert len(asked) == 2 * periods
    times = [event["time_s"] for event in run.events if event["event"] == "fallback"]
    assert start_s(scenario) <= min(times) < max(times) < start_s(scenario) + WINDOW_S


def piece_of(variant: Variant, scenario: Scenario, seed: int, path: Path, **other: str) -> dict:
    """File of rows that were never simulated."""
    row = {"vehicle": "quarter", "scenario": scenario.name, "seed": seed, "metrics": {"objective": -1.0}}
    row |= settings(variant, scenario) | other
    path.write_text(json.dumps({"variants": {variant.name: [row]}}))
    return row


def test_rows_of_pieces_are_not_driven_anew(short: Scenario, tmp_path: Path) -> None:
    variant, piece = Variant("soft", "passive", "none", [short]), tmp_path / "piece.json"
    row = piece_of(variant, short, 4, piece)
    done = run_all([variant], [3, 4], [piece])
    (driven,), (read,) = done["soft"]
    assert read == row
    assert driven["metrics"]["objective"] > 0.0
    write(piece, done)
    assert run_all([variant], [3, 4], [piece]) == json.loads(to_json(done))


def test_rows_driven_with_other_settings_are_refused(short: Scenario, tmp_path: Path) -> None:
    variant, piece = Variant("soft", "passive", "none", [short]), tmp_path / "piece.json"
    piece_of(variant, short, 4, piece)
    other = variant._replace(scenarios=[replace(short, tyre_load_weight=5.0)])
    with pytest.raises(InputError, match=r"piece\.json: .* other settings .* scenario_hash must be") as error:
        run_all([other], [4], [piece])
    assert "\n" not in str(error.value)
    piece_of(variant, short, 4, piece, perception="camera")
    with pytest.raises(InputError, match=r"perception must be none, got camera"):
        run_all([variant], [4], [piece])


@pytest.mark.parametrize("content", [None, "no json", "{}", "[]", '{"variants": {"soft": [{}]}}', "\xff"])
def test_pieces_that_cannot_be_read_are_named(short: Scenario, tmp_path: Path, content: str | None) -> None:
    piece = tmp_path / "piece.json"
    if content is not None:
        piece.write_text(content, encoding="latin-1")
    with pytest.raises(InputError, match=r"piece\.json: expected what --json of this table writes") as error:
        run_all([Variant("soft", "passive", "none", [short])], [4], [piece])
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["faults", "--lines", "solver fials"], "--lines: must be of body_acc stuck, "),
        (["degraded", "--lines", "20 % missed,fog"], "--lines: must be of true, bias +0.1 m, "),
        (["degraded", "--seeds", "x"], "--seeds: must be whole numbers in 0 ... 4294967295"),
        (["rivals", "--events", "nowhere.yaml"], "nowhere.yaml: no such scenario file"),
        (["rivals", "--json", "no/folder/"], "no/folder"),
        (["budget", "--set", "speed_kmh"], "must read path.to.field=value"),
        (["proving_ground", "--vehicles", "tank"], "tank"),
        (["wrong_previews", "--drives", "0"], "--drives and --jobs must be >= 1"),
        (["wrong_previews", "--json", "rows.jsonl"], "rows.jsonl: expected the rows of this table"),
    ],
)
def test_bad_input_is_told_in_one_line_before_anything_is_driven(
    words: list[str],
    said: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture,
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("rows.jsonl").write_text('{"drive": 1000}\n')
    Path("no").write_text("a file")
    assert cli.main(["table", *words]) == 2
    told = capsys.readouterr().err
    assert told.startswith("foreride: ")
    assert said in told
    assert told.count("\n") == 1


def test_every_table_is_a_command_with_help(capsys: pytest.CaptureFixture) -> None:
    for name in TABLES:
        with pytest.raises(SystemExit, match="0"):
            cli.main(["table", name, "--help"])
        assert capsys.readouterr().out.startswith(f"usage: foreride table {name} ")


def test_random_drives_are_drawn_from_their_number_and_resumed(tmp_path: Path) -> None:
    rows = tmp_path / "rows.jsonl"
    words = ["table", "wrong_previews", "--first", "0", "--json", str(rows), "--drives"]
    assert cli.main([*words, "1"]) == 0
    (first,) = rows.read_text().splitlines()
    assert cli.main([*words, "2"]) == 0
    again, second = rows.read_text().splitlines()
    assert again == first
    assert [json.loads(row)["drive"] for row in (first, second)] == [0, 1]


@pytest.mark.parametrize(
    ("model", "without"), [("quarter", {"pitch_rate stuck", "pitch_rate silent"}), ("half", set())]
)
def test_the_table_of_faults_has_each_fault_that_the_car_can_have(
    tmp_path: Path, model: str, without: set[str]
) -> None:
    (tmp_path / "short.yaml").write_text(SHORT)
    scenarios = [load(str(tmp_path / "short.yaml"), [f"vehicle.model={model}"])]
    names = names_for(scenarios)
    assert set(names_for([])) - set(names) == without
    for name in names:
        assert len(variants(name, scenarios)) == 2
