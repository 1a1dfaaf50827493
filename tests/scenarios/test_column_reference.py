"""Tests that every column of the Parquet files has a unit and a meaning, on its page and in the code."""

from dataclasses import fields

import pyarrow as pa
import pytest

from foreride.scenarios.cases import Case
from foreride.scenarios.column_reference import column_page
from foreride.scenarios.comparison.document import flat
from foreride.scenarios.comparison.row_columns import definition_of
from foreride.scenarios.definition.loading import load
from foreride.scenarios.runs.write import row
from foreride.scenarios.simulation.preview_log import PreviewLog
from foreride.scenarios.simulation.simulate import Run, simulate
from foreride.scenarios.studies.study import Sample
from foreride.scenarios.studies.sweep import sample_columns
from foreride.vehicle.state import signal_definition, signal_definitions

SHORT = {"speed_kmh": 40, "road": {"length_m": 20, "features.0.start_m": 12}}


@pytest.fixture(scope="module", params=["half", "full"])
def run(request: pytest.FixtureRequest) -> Run:
    scenario = load("bump_8x40_30", {**SHORT, "vehicle.model": request.param})
    return simulate(Case(scenario, "mpc_preview", "boxes", 0))


def test_every_signal_of_a_run_has_a_unit_and_a_meaning(run: Run) -> None:
    page = column_page()
    for name in run.signals:
        unit, meaning = signal_definition(name)
        assert unit
        assert meaning
    for name, (unit, meaning) in signal_definitions().items():
        assert f"| `{name}` | {unit} | {meaning} |" in page


def test_every_column_of_the_previews_is_on_the_page() -> None:
    page = column_page()
    assert all(f"| `{item.name}` | " in page for item in fields(PreviewLog))


def test_every_column_of_a_row_has_a_meaning(run: Run) -> None:
    sample = Sample("a.yaml", (("speed_kmh", 30),), "passive", "none", 0)
    bound = {"objective": 1.0, "gap_between_starts": 0.0, "passive_objective": 2.0}
    columns = {**flat(row(run) | {"bound": bound}), **sample_columns(sample, None)}
    assert pa.Table.from_pylist([columns]).num_rows == 1
    for name in columns:
        assert definition_of(name)[1], name


def test_an_unknown_column_has_none() -> None:
    with pytest.raises(KeyError):
        definition_of("nonsense")
