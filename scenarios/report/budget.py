"""Comfort budget section of the report: cost of each error source relative to the gain of preview."""

from pathlib import Path
from typing import Any

from foreride.files.errors import InputError, shortened
from foreride.files.reading.strict_json import read_json
from foreride.scenarios.report.markup import text
from foreride.scenarios.report.sections import bar_of, scrolling, table, with_small

_NUMBERS = ("reactive", "whole", "all_true")


def error_budget_section(path: Path) -> str:
    """HTML section for the output of `foreride table budget --json`, one table per event.

    Raises InputError for a file that is no such budget.
    """
    document = read_json(path)
    try:
        events = [_event(event) for event in document["table"]]
        seeds = len(document["seeds"])
        summary = f"{document['vehicle']} car, {f'means over {seeds} seeds' if seeds > 1 else 'one seed'}"
    except (ValueError, ArithmeticError, LookupError, TypeError, AttributeError) as error:
        problem = shortened(f"{type(error).__name__}: {error}", 100)
        raise InputError(f"{path}: is not a comfort budget ({problem})") from None
    note = (
        f"{summary}. J is relative to passive. A source's cost is the share of the possible gain that would "
        "be kept in addition if it were exact; costs need not add up, because errors hide one another."
    )
    body = f'{"".join(events)}<p class="hint">{text(note)}</p>'
    return f"<section><h2>Where the gain is lost</h2>{body}</section>"


def _event(event: dict[str, Any]) -> str:
    title = text(event["event"])
    reactive, whole, exact = (float(event[name]) for name in _NUMBERS)

    def share(value: float | None, digits: int) -> str:
        """Format as a percentage; a dash if there was no possible gain."""
        return "-" if value is None and reactive <= exact else f"{float(value):.{digits}%}"  # type: ignore[arg-type]

    lines: list[list[str]] = [["reactive MPC, no preview", "", "", f"{reactive:.3f}", ""]]
    costs = [float(source["cost"] or 0.0) for source in event["sources"]]
    maximum = max(map(abs, [*costs, 1e-9]))
    for cost, source in sorted(zip(costs, event["sources"], strict=True), key=lambda pair: -pair[0]):
        bar = bar_of(max(cost, 0.0) / maximum)
        name = with_small(f"{source['source']} exact ", str(source["replaced_by"]))
        lines.append([name, bar, share(source["cost"], 1), f"{float(source['objective']):.3f}", ""])
    lines += [
        ["not of a single source", "", share(event["rest"], 1), "", ""],
        ["whole chain as it drives", "", "", f"{whole:.3f}", share(event["kept"], 0)],
        ["all of it exact", "", "", f"{exact:.3f}", "100%"],
    ]
    heads = ["drive with", "", "cost of its error", "J / passive", "kept of the gain"]
    return f"<h3>{title}</h3>{scrolling(table(heads, lines, 1))}"
