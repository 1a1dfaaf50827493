"""Comparison table in the terminal, in Markdown and in LaTeX."""

from collections.abc import Sequence
from itertools import groupby

from rich import box
from rich.table import Table

from foreride.comfort.registry import METRICS, Column
from foreride.files.errors import printable
from foreride.scenarios.comparison.statistics import Interval, Variant


def columns() -> list[tuple[str, Column]]:
    """Metrics displayed in tables, each with its column: foreride's own, then those added."""
    return [(name, metric.column) for name, metric in METRICS.parts().items() if metric.column is not None]


_HIDDEN_IF_NARROW = ("peak_acc", "rattle_peak", "stop_time")
_WIDE = 130
_HEADS = ("scenario", "controller", "preview")
_OBJECTIVE = Column("J", "(m/s²)²")


def comparison(
    variants: Sequence[Variant], title: str = "", width: int = _WIDE, baseline: str | None = None
) -> Table:
    """Terminal table: means over seeds; J relative to the baseline with its confidence interval.

    `width` is that of the terminal in characters; a narrow one gets fewer columns.
    """
    displayed = [
        (name, column) for name, column in columns() if width >= _WIDE or name not in _HIDDEN_IF_NARROW
    ]
    captured = any(variant.captured for variant in variants)
    table = Table(title=title or None, box=box.SIMPLE_HEAD, title_justify="left", pad_edge=False)
    for name in _HEADS:
        table.add_column(name, no_wrap=True)
    table.add_column(_effect_head(variants, baseline).replace(" / ", " /\n"), justify="right", no_wrap=True)
    if captured:
        table.add_column("cap-\ntured", justify="right", no_wrap=True)
    for _, column in displayed:
        table.add_column(f"{column.name}\n{column.unit}", justify="right")
    table.add_column("fall-\nbacks", justify="right")
    for _, group in groupby(variants, key=lambda variant: (variant.scenario, variant.vehicle)):
        members = list(group)
        for index, variant in enumerate(members):
            first = variant.scenario if index == 0 else ""
            cells = [first, short_name(variant.controller), variant.perception]
            cells.append(_shown(*_effect(variant), spread=True))
            cells += [_percent(variant.captured)] if captured else []
            cells += [_shown(variant.metrics.get(name), column) for name, column in displayed]
            cells.append(str(variant.fallbacks) if variant.fallbacks else "-")
            table.add_row(*cells, end_section=index == len(members) - 1)
    return table


def markdown(variants: Sequence[Variant], baseline: str | None = None) -> str:
    """Comparison as a Markdown table (GitHub's pipes), every number with its interval."""
    heads, rows = _full(variants, baseline)
    align = ["---"] * len(_HEADS) + ["---:"] * (len(heads) - len(_HEADS))
    return "".join(f"| {' | '.join(map(_markdown_cell, cells))} |\n" for cells in (heads, align, *rows))


def latex(variants: Sequence[Variant], baseline: str | None = None) -> str:
    """Comparison as a LaTeX `tabular`; needs the package booktabs."""
    heads, rows = _full(variants, baseline)
    lines = [
        "% \\usepackage{booktabs}",
        f"\\begin{{tabular}}{{{'l' * len(_HEADS)}{'r' * (len(heads) - len(_HEADS))}}}",
        "\\toprule",
        _tex_row(heads),
        "\\midrule",
        *(_tex_row(row) for row in rows),
        "\\bottomrule",
        "\\end{tabular}",
    ]
    return "\n".join(lines) + "\n"


def short_name(controller: str) -> str:
    """Name of a controller without its file."""
    return controller.rpartition(":")[2]


def _full(variants: Sequence[Variant], baseline: str | None) -> tuple[list[str], list[list[str]]]:
    captured = any(variant.captured for variant in variants)
    heads = [*_HEADS, "seeds", _effect_head(variants, baseline), *(["captured"] if captured else [])]
    heads += [f"{column.name} ({column.unit})" for _, column in columns()]
    rows = []
    for variant in variants:
        row = [variant.scenario, short_name(variant.controller), variant.perception, str(len(variant.seeds))]
        row.append(_shown(*_effect(variant), spread=True))
        row += [_percent(variant.captured)] if captured else []
        rows.append(
            row + [_shown(variant.metrics.get(name), column, spread=True) for name, column in columns()]
        )
    return heads, rows


def _effect(variant: Variant) -> tuple[Interval, Column]:
    """J relative to the baseline, or J itself without one."""
    return variant.ratio.get("objective", variant.metrics["objective"]), _OBJECTIVE


def _effect_head(variants: Sequence[Variant], baseline: str | None) -> str:
    relative = all("objective" in variant.ratio for variant in variants)
    return f"J / {baseline}" if relative and baseline else "J"


def _shown(value: Interval | None, column: Column, spread: bool = False) -> str:
    if value is None:
        return "-"
    text = column.shown(value.mean)
    if not spread or value.low is None or value.high is None or value.low == value.high:
        return text
    low, high = column.shown(value.low), column.shown(value.high)
    return f"{text} [{low} {high}]"


def _percent(value: Interval | None) -> str:
    return "-" if value is None else f"{100 * value.mean:.1f} %"


def _markdown_cell(cell: str) -> str:
    return printable(cell).replace("\\", "\\\\").replace("|", "\\|").replace("<", "&lt;")


_TEX = {"\\": r"\textbackslash{}", "²": "$^2$", "^": r"\^{}", "~": r"\textasciitilde{}"} | {
    letter: f"\\{letter}" for letter in "_%&#${}"
}


def _tex_row(cells: Sequence[str]) -> str:
    return (
        " & ".join("".join(_TEX.get(letter, letter) for letter in printable(cell)) for cell in cells) + r" \\"
    )
