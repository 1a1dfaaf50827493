"""Comparison table in the terminal, in Markdown and in LaTeX."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby

from rich import box
from rich.table import Table

from foreride.files.errors import printable
from foreride.scenarios.comparison.statistics import Interval, Variant


@dataclass(frozen=True)
class Column:
    """Displayed metric: heading, unit, key in `metrics`, format and factor."""

    name: str
    unit: str
    metric: str
    style: str
    factor: float = 1.0


COLUMNS = (
    Column("Wk RMS", "m/s²", "wk_rms", ".3f"),
    Column("VDV", "m/s^1.75", "vdv", ".2f"),
    Column("peak acc.", "m/s²", "peak_acc", ".2f"),
    Column("rattle peak", "mm", "rattle_peak", ".0f", 1e3),
    Column("stops", "ms", "stop_time", ".0f", 1e3),
    Column("tyre load", "RMS", "tyre_load_rms", ".3f"),
    Column("lift", "ms", "lift_time", ".0f", 1e3),
)
_ESSENTIAL = ("wk_rms", "vdv", "tyre_load_rms", "lift_time")
_WIDE = 130
_HEADS = ("scenario", "controller", "preview")
_OBJECTIVE = Column("J", "(m/s²)²", "objective", ".3f")


def comparison(
    variants: Sequence[Variant], title: str = "", width: int = _WIDE, baseline: str | None = None
) -> Table:
    """Terminal table: means over seeds; J relative to the baseline with its confidence interval.

    `width` is that of the terminal in characters; a narrow one gets the essential columns only.
    """
    columns = [column for column in COLUMNS if width >= _WIDE or column.metric in _ESSENTIAL]
    captured = any(variant.captured for variant in variants)
    table = Table(title=title or None, box=box.SIMPLE_HEAD, title_justify="left", pad_edge=False)
    for name in _HEADS:
        table.add_column(name, no_wrap=True)
    table.add_column(_effect_head(variants, baseline).replace(" / ", " /\n"), justify="right", no_wrap=True)
    if captured:
        table.add_column("cap-\ntured", justify="right", no_wrap=True)
    for column in columns:
        table.add_column(f"{column.name}\n{column.unit}", justify="right")
    table.add_column("fall-\nbacks", justify="right")
    for _, group in groupby(variants, key=lambda variant: (variant.scenario, variant.vehicle)):
        members = list(group)
        for index, variant in enumerate(members):
            first = variant.scenario if index == 0 else ""
            cells = [first, short_name(variant.controller), variant.perception]
            cells.append(_shown(*_effect(variant), spread=True))
            cells += [_percent(variant.captured)] if captured else []
            cells += [_shown(variant.metrics[column.metric], column) for column in columns]
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
    heads += [f"{column.name} ({column.unit})" for column in COLUMNS]
    rows = []
    for variant in variants:
        row = [variant.scenario, short_name(variant.controller), variant.perception, str(len(variant.seeds))]
        row.append(_shown(*_effect(variant), spread=True))
        row += [_percent(variant.captured)] if captured else []
        rows.append(row + [_shown(variant.metrics[c.metric], c, spread=True) for c in COLUMNS])
    return heads, rows


def _effect(variant: Variant) -> tuple[Interval, Column]:
    """J relative to the baseline, or J itself without one."""
    return variant.ratio.get("objective", variant.metrics["objective"]), _OBJECTIVE


def _effect_head(variants: Sequence[Variant], baseline: str | None) -> str:
    relative = all("objective" in variant.ratio for variant in variants)
    return f"J / {baseline}" if relative and baseline else "J"


def _shown(value: Interval, column: Column, spread: bool = False) -> str:
    text = format(value.mean * column.factor, column.style)
    if not spread or value.low is None or value.high is None or value.low == value.high:
        return text
    low, high = (format(limit * column.factor, column.style) for limit in (value.low, value.high))
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
