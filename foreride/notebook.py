"""Views of results in notebooks, as HTML."""

from collections.abc import Iterable, Sequence
from html import escape
from typing import TYPE_CHECKING

import numpy as np

from foreride.comfort import METRICS
from foreride.scenarios.report.palette import colours_of
from foreride.scenarios.report.window import event_window

if TYPE_CHECKING:
    from foreride.results import Result

_WIDTH, _HEIGHT, _POINTS = 640, 110, 320
_ROAD_COLOUR = "#555a60"


def result_view(result: "Result") -> str:
    """Traces of seat acceleration and road around the event, above the table of the metrics."""
    known = METRICS.parts()
    rows = [
        (name, f"{value:.4g}", known[name].definition if name in known else "")
        for name, value in result.metrics.items()
    ]
    (colour,) = colours_of([result.record.case.controller]).values()
    traces = _trace(result, "seat_acc_0", colour) + _trace(result, "road_height_0", _ROAD_COLOUR)
    return f"<p>{escape(repr(result)[1:-1])}</p>{traces}{table(('metric', 'value', 'meaning'), rows)}"


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Table of texts."""
    heads = "".join(f"<th>{escape(cell)}</th>" for cell in head)
    lines = ("".join(f"<td>{escape(cell)}</td>" for cell in row) for row in rows)
    return f"<table><tr>{heads}</tr>{''.join(f'<tr>{line}</tr>' for line in lines)}</table>"


def _trace(result: "Result", name: str, colour: str) -> str:
    """One signal around the event as an SVG line, with its range."""
    start, end = event_window(result.record)
    ticks = np.linspace(start, end, _POINTS).astype(int)
    values = result.signals[name][ticks]
    low, high = float(values.min()), float(values.max())
    down = (high - values) / (high - low or 1.0) * (_HEIGHT - 30) + 20
    across = np.linspace(0, _WIDTH, _POINTS)
    points = " ".join(f"{x:.1f},{y:.1f}" for x, y in zip(across, down, strict=True))
    from_s, to_s = (result.signals["time_s"][tick] for tick in (start, end))
    told = f"{name}: {low:.3g} ... {high:.3g} {result.units[name]}, {from_s:.1f} ... {to_s:.1f} s"
    return (
        f'<svg width="{_WIDTH}" height="{_HEIGHT}" style="display:block">'
        f'<text x="0" y="12" font-size="12" fill="{colour}">{escape(told)}</text>'
        f'<polyline points="{points}" fill="none" stroke="{colour}"/></svg>'
    )
