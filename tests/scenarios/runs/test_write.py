"""Tests of the tables of a run: numbers and types of their columns, and what writing them imports."""

import subprocess
import sys

import numpy as np
import pyarrow as pa

from foreride.scenarios.runs.write import preview_table, signal_table
from foreride.scenarios.simulation.preview_log import PreviewLog, collect

LOG = PreviewLog(
    np.array([0.0, 0.05], np.float32),
    np.array([0.0, 0.1, 0.2], np.float32),
    *np.arange(18, dtype=np.float32).reshape(3, 2, 3),
)
NO_PANDAS = """
import sys
import numpy as np
from foreride.scenarios.runs.write import signal_table, to_parquet
to_parquet(signal_table({"time_s": np.arange(3.0)}))
assert "pyarrow" in sys.modules
assert "pandas" not in sys.modules
"""


def test_columns_hold_the_signals_even_of_strided_arrays() -> None:
    rows = np.arange(12.0).reshape(4, 3)
    table = signal_table({"time_s": rows[:, 0], "x_m": rows[:, 2]})
    assert table["time_s"].to_pylist() == rows[:, 0].tolist()
    assert table["x_m"].to_pylist() == rows[:, 2].tolist()
    assert table.schema.field("x_m").metadata == {b"unit": b"m"}


def test_previews_are_numbers_and_lists_of_numbers() -> None:
    table = preview_table(LOG)
    assert table.schema.field("time_s").type == pa.float32()
    assert table.schema.field("height_m").type == pa.list_(pa.float32())
    assert table["height_m"].to_pylist() == LOG.height_m.tolist()
    assert table["distance_m"].to_pylist() == [LOG.distance_m.tolist()] * 2
    assert preview_table(collect([])).num_rows == 0


def test_writing_does_not_import_pandas() -> None:
    """Importing it takes several times as long as writing a run."""
    subprocess.run([sys.executable, "-c", NO_PANDAS], check=True)
