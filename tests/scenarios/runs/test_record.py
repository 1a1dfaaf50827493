"""Tests of the run record: manifest, row and reader have the same fields."""

import json

import pytest

from foreride.files.errors import InputError
from foreride.scenarios.cases import Case
from foreride.scenarios.definition.loading import load
from foreride.scenarios.runs.record import RunRecord
from foreride.scenarios.runs.write import manifest, row, to_json
from foreride.scenarios.simulation.simulate import Run, simulate


@pytest.fixture(scope="module")
def run() -> Run:
    short = ["vehicle.model=quarter", "road.length_m=22", "road.features.0.start_m=10"]
    return simulate(Case(load("bump_8x40_30", short), "passive", "none", 3))


def test_row_and_manifest_hold_the_record(run: Run) -> None:
    record = RunRecord.of(run).mapping()
    assert record.items() <= {name: row(run)[name] for name in record}.items()
    assert {name: manifest(run)[name] for name in record} == record
    assert set(row(run)) == set(record) | {"metrics"}
    assert "bound" not in record


def test_the_record_comes_back_from_a_manifest(run: Run) -> None:
    assert RunRecord.read(json.loads(to_json(manifest(run))), "run") == RunRecord.of(run)


def test_a_missing_field_is_named(run: Run) -> None:
    lacking = {name: value for name, value in manifest(run).items() if name != "solver"}
    with pytest.raises(InputError, match=r"^run: its files lack 'solver'; a run of another version"):
        RunRecord.read(lacking, "run")
