"""Perception report as terminal tables."""

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

from rich import box
from rich.table import Table

from foreride.scenarios.perception_benchmark.judge import EVALUATION_DISTANCE_M
from foreride.scenarios.perception_benchmark.summary import BINS_M

Row = dict[str, Any]
_COLUMNS = (
    ("events", "events", "d", 1),
    ("missed", "missed", "d", 1),
    ("false\nper km", "false_per_km", ".1f", 1),
    ("first seen\nm (median)", "first_confirmed_median_m", ".1f", 1),
    ("bias\ncm", "bias_m", "+.1f", 100),
    ("sigma\ncm", "sigma_m", ".1f", 100),
    ("timing\nms (95 %)", "timing_ms_95", ".1f", 1),
    ("error² /\nclaimed", "nees", ".2f", 1),
    ("95 %\nband", "nees_band", ".2f", 1),
    ("height\nerror %", "height_error_rms", ".0f", 100),
    ("right\nkind %", "right_kind", ".0f", 100),
    ("estimator\nms", "estimator_median_ms", ".2f", 1),
)
_ORDERS = (1, 5)  # of a drive: before and after online calibration
_FINE_M = 8.0  # distance up to which millimetres are shown


def use_table(rows: Sequence[Row]) -> Table:
    """Statistics of `scenarios.perception_benchmark.summary` at the distance of use, one line per row."""
    title = f"near edge {EVALUATION_DISTANCE_M:g} m before the front wheel"
    lines = [[_cell(row[key], style, factor) for _, key, style, factor in _COLUMNS] for row in rows]
    return _table(title, [title for title, _, _, _ in _COLUMNS], rows, lines)


def error_table(rows: Sequence[Row]) -> Table:
    """Bias and sigma by distance, and the timing at the first and a later obstacle of the drives."""
    bins = list(pairwise(BINS_M))
    titles = [f"{near:g}-{far:g} m" for near, far in bins] + [f"no. {n}\nms (95 %)" for n in _ORDERS]
    lines = []
    for row in rows:
        at = {(one["from_m"], one["to_m"]): one for one in row["by_distance"]}
        order = {one["order"]: one["timing_ms_95"] for one in row["by_order"]}
        errors = [_error(at[span]) if span in at else "-" for span in bins]
        lines.append(errors + [_cell(order.get(n), ".1f", 1) for n in _ORDERS])
    return _table("bias / sigma (cm) by distance; timing of a drive's obstacles", titles, rows, lines)


def _table(title: str, columns: Sequence[str], rows: Sequence[Row], lines: Sequence[list[str]]) -> Table:
    table = Table(title=title, box=box.SIMPLE_HEAD, title_justify="left")
    table.add_column("", no_wrap=True)
    for column in columns:
        table.add_column(column, justify="right", no_wrap=True)
    for row, cells in zip(rows, lines, strict=True):
        table.add_row(row["name"], *cells)
    return table


def _cell(value: Any, style: str, factor: float) -> str:
    """Format a number or a range of numbers."""
    if value is None:
        return "-"
    values = value if isinstance(value, list) else [value]
    return "-".join(format(one * factor, style) for one in values)


def _error(one: Row) -> str:
    digits = 1 if one["to_m"] <= _FINE_M else 0
    return f"{100 * one['bias_m']:+.{digits}f} / {100 * one['sigma_m']:.{digits}f}"
