"""Columns of comparison tables: the objective, the share captured, counts, and any metric or its ratio."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from foreride.comfort.registry import METRICS, Column
from foreride.files.errors import InputError, nearest, shown
from foreride.scenarios.comparison.statistics import Interval, Variant

RATIO = "/baseline"
"""Suffix of a metric's name for its ratio to the baseline's run of the same seed."""
UNCHANGED = "[=]"
"""Stands for an interval whose ends coincide, as every seed gives the same value."""


@dataclass(frozen=True)
class TableColumn:
    """Column of a table: heading and format, and the value that it shows of a variant (None: none)."""

    key: str
    column: Column
    value: Callable[[Variant], Interval | None]

    @property
    def head(self) -> str:
        """Heading with its unit."""
        return f"{self.column.name} ({self.column.unit})" if self.column.unit else self.column.name

    def cell(self, variant: Variant, spread: bool = False) -> str:
        """Text of a cell: the mean and, with `spread`, its confidence interval."""
        value, column = self.value(variant), self.column
        if value is None:
            return "-"
        text = column.shown(value.mean)
        if not spread or value.low is None or value.high is None:
            return text
        if value.low == value.high:
            return f"{text} {UNCHANGED}"
        return f"{text} [{column.shown(value.low)} {column.shown(value.high)}]"


def metric_columns() -> list[tuple[str, Column]]:
    """Metrics displayed unless others are chosen, each with its column: foreride's own, then added ones."""
    return [(name, metric.column) for name, metric in METRICS.parts().items() if metric.column is not None]


def default_keys(variants: Sequence[Variant]) -> list[str]:
    """Columns shown unless others are chosen."""
    captured = any(variant.captured for variant in variants)
    metrics = [name for name, _ in metric_columns()]
    return ["J", *(["captured"] if captured else []), *metrics, "fallbacks"]


def check_keys(keys: Sequence[str]) -> None:
    """Raise InputError for a key that names no column."""
    known = [*_PLAIN, *METRICS.names(), *(f"{name}{RATIO}" for name in METRICS.names())]
    for key in keys:
        if key not in known:
            allowed = f"{', '.join(_PLAIN)}, or a metric such as wk_rms or its ratio wk_rms{RATIO}"
            raise InputError(f"--columns must be {allowed}, got {shown(key)}{nearest(key, known)}")


def columns_of(
    variants: Sequence[Variant], baseline: str | None, keys: Sequence[str] | None = None
) -> list[TableColumn]:
    """Columns of a table of the variants; the default ones without `keys`."""
    keys = default_keys(variants) if keys is None else keys
    check_keys(keys)
    return [_PLAIN[key](variants, baseline) if key in _PLAIN else _metric(key, baseline) for key in keys]


def _objective(variants: Sequence[Variant], baseline: str | None) -> TableColumn:
    """J relative to the baseline, or J itself without one."""
    relative = baseline is not None and all("objective" in variant.ratio for variant in variants)
    column = Column(f"J / {baseline}", "") if relative else Column("J", "(m/s²)²")
    return TableColumn("J", column, lambda v: v.ratio.get("objective", v.metrics["objective"]))


def _metric(key: str, baseline: str | None) -> TableColumn:
    name = key.removesuffix(RATIO)
    metric = METRICS.find(name)
    assert metric is not None
    column = metric.column or Column(name, metric.unit, ".3g")
    if key == name:
        return TableColumn(key, column, lambda v: v.metrics.get(name))
    return TableColumn(key, Column(f"{column.name} / {baseline or '-'}", ""), lambda v: v.ratio.get(name))


def _count(key: str, count: Callable[[Variant], int]) -> TableColumn:
    return TableColumn(key, Column(key, "", ".0f"), lambda variant: Interval(count(variant)))


_CAPTURED = Column("captured", "%", ".1f", 100)
_PLAIN: dict[str, Callable[[Sequence[Variant], str | None], TableColumn]] = {
    "J": _objective,
    "captured": lambda _, __: TableColumn("captured", _CAPTURED, lambda variant: variant.captured),
    "seeds": lambda _, __: _count("seeds", lambda variant: len(variant.seeds)),
    "fallbacks": lambda _, __: _count("fallbacks", lambda variant: variant.fallbacks),
}
