"""Generated reference page (Markdown) of the columns of Parquet files."""

from collections.abc import Mapping
from typing import get_type_hints

from foreride.scenarios.comparison.row_columns import definitions
from foreride.scenarios.simulation.preview_log import PreviewLog
from foreride.vehicle.state import signal_definitions

_HEAD = """# Columns of the Parquet files

Generated from the code. Axes, signs and the places of measurement are explained under
[conventions](../conventions.md).
"""
_SIGNALS = """## signals.parquet

One row for each tick of 1 ms. Signals of a wheel end in its index, `_0`, `_1`, …: front, rear, or front
left, front right, rear left, rear right; `seat_acc` ends in the index of the seat. The unit of each column
also stands in the metadata of its field in the file.
"""
_PREVIEWS = """## previews.parquet

One row for each preview given to the controller, at most 20 per second, for the right front wheel. Columns
with a value for each distance hold lists, one value every 0.1 m.
"""
_ROWS = """## Rows of a comparison or study

`compare --parquet` and the folder `drives` of a study hold one row per drive: the columns below, every
[metric](metrics.md) under its own name, and in a study the varied field `path.to.field` as
`set.path.to.field`. Columns that a drive lacks are left out or null.
"""


def column_page() -> str:
    """Page of all columns: unit and meaning."""
    hints = get_type_hints(PreviewLog, include_extras=True)
    previews = {name: hint.__metadata__ for name, hint in hints.items()}
    parts = (_SIGNALS, signal_definitions()), (_PREVIEWS, previews), (_ROWS, definitions())
    return "\n".join([_HEAD, *(f"{head}\n{_table(rows)}" for head, rows in parts)])


def _table(rows: Mapping[str, tuple[str, str]]) -> str:
    lines = ["| column | unit | meaning |", "|---|---|---|"]
    lines += [
        f"| `{name}` | {'' if unit == '1' else unit} | {meaning} |" for name, (unit, meaning) in rows.items()
    ]
    return "\n".join(lines) + "\n"
