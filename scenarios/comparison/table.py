"""Comparison table in the terminal."""

from collections.abc import Sequence
from itertools import groupby

from rich import box
from rich.table import Table

from foreride.scenarios.comparison.columns import UNCHANGED, columns_of, default_keys
from foreride.scenarios.comparison.statistics import Variant

HEADS = ("scenario", "controller", "preview")
_HIDDEN_IF_NARROW = ("peak_acc", "rattle_peak", "stop_time")
_WIDE = 130


def comparison(
    variants: Sequence[Variant],
    title: str = "",
    width: int = _WIDE,
    baseline: str | None = None,
    keys: Sequence[str] | None = None,
) -> Table:
    """Terminal table: means over seeds; J relative to the baseline with its confidence interval.

    width: of the terminal in characters; a narrow one gets fewer columns, unless `keys` choose them.
    """
    usual = [key for key in default_keys(variants) if width >= _WIDE or key not in _HIDDEN_IF_NARROW]
    columns = columns_of(variants, baseline, usual if keys is None else keys)
    table = Table(title=title or None, box=box.SIMPLE_HEAD, title_justify="left", pad_edge=False)
    for name in HEADS:
        table.add_column(name, no_wrap=True)
    for item in columns:
        head = _stacked(item.column.name, item.column.unit)
        table.add_column(head, justify="right", no_wrap=item.key == "J")
    for _, group in groupby(variants, key=lambda variant: (variant.scenario, variant.vehicle)):
        members = list(group)
        for index, variant in enumerate(members):
            first = variant.scenario if index == 0 else ""
            cells = [first, short_name(variant.controller), variant.perception]
            cells += [item.cell(variant, item.key == "J").removesuffix(f" {UNCHANGED}") for item in columns]
            table.add_row(*cells, end_section=index == len(members) - 1)
    return table


def short_name(controller: str) -> str:
    """Name of a controller without its file."""
    return controller.rpartition(":")[2]


def _stacked(name: str, unit: str) -> str:
    """Heading in two lines, as narrow as its parts."""
    broken = {"captured": "cap-\ntured", "fallbacks": "fall-\nbacks"}.get(name, name.replace(" / ", " /\n"))
    return broken if "\n" in broken else f"{name}\n{unit}"
