"""Tables of the HTML report."""

import json
from collections.abc import Mapping, Sequence
from html import escape
from itertools import groupby

from foreride.comfort.registry import Column
from foreride.scenarios.comparison.columns import metric_columns
from foreride.scenarios.comparison.statistics import Interval, Variant
from foreride.scenarios.comparison.table import short_name
from foreride.scenarios.perceptions.registry import PERCEPTIONS
from foreride.scenarios.report.labels import label_of, variant_label
from foreride.scenarios.report.markup import Html, text
from foreride.scenarios.runs.write import manifest, to_json
from foreride.scenarios.simulation.simulate import Run

_REACTIVE = ("mpc_reactive", "none")
_J = Column("J", "(m/s²)²")
_SHARE = Column("captured", "", ".1%")

Drive = tuple[str, str]
"""Names of a scenario and of a vehicle."""


def metrics_section(
    variants: Sequence[Variant], baseline: str | None, colours: Mapping[str, str], titles: Mapping[Drive, str]
) -> str:
    """Bars of J and a table of all metrics for each drive, in the order of the variants."""
    parts = []
    for drive, group in groupby(variants, key=lambda v: (v.scenario, v.vehicle)):
        members = list(group)
        named = with_small(titles.get(drive, ""), " · ".join(drive)) if drive in titles else " · ".join(drive)
        parts.append(f"<h2>{text(named)}</h2>{bars(members, baseline, colours)}")
        parts.append(scrolling(_metrics_table(members, baseline)))
    return f"<section>{''.join(parts)}</section>"


def bars(variants: Sequence[Variant], baseline: str | None, colours: Mapping[str, str]) -> str:
    """Bar chart of J, relative to the baseline if there is one, with the intervals over seeds."""
    effects = [_effect(v) for v in variants]
    greatest = (
        max(value.mean if value.high is None else max(value.mean, value.high) for value in effects) or 1.0
    )
    rows = []
    for v, value in zip(variants, effects, strict=True):
        name = variant_label(v.controller, v.perception)
        fill = f"width:{100 * value.mean / greatest:.2f}%;background:{colours[v.controller]}"
        spread = ""
        if value.low is not None and value.high is not None and value.high > value.low:
            at, wide = (100 * part / greatest for part in (value.low, value.high - value.low))
            spread = f'<span class="spread" style="left:{at:.2f}%;width:{wide:.2f}%"></span>'
        rows.append(
            f'<span class="name">{text(name)}</span><span class="value">{text(_cell(value, _J, " "))}</span>'
            f'<span class="track"><span class="fill" style="{fill}"></span>{spread}</span>'
        )
    return f'<h3>{text(_effect_name(baseline))}</h3><div class="bars">{"".join(rows)}</div>'


def _metrics_table(variants: Sequence[Variant], baseline: str | None) -> str:
    captured = any(v.captured for v in variants)
    heads: list[str] = ["controller", "preview", _effect_name(baseline), *(["captured"] if captured else [])]
    heads += [_two_lines(c.name, c.unit) for _, c in metric_columns()] + ["fallbacks", "seeds"]
    rows = []
    for v in variants:
        row: list[str] = [short_name(v.controller), v.perception, _cell(_effect(v), _J)]
        row += [_cell(v.captured, _SHARE)] if captured else []
        row += [_cell(v.metrics.get(name), column) for name, column in metric_columns()]
        rows.append([*row, str(v.fallbacks), str(len(v.seeds))])
    return table(heads, rows, left=2)


def budget_section(variants: Sequence[Variant]) -> str:
    """Fraction of the possible gain of preview over the reactive MPC that each perception keeps."""
    rows = []
    for (scenario, vehicle), group in groupby(variants, key=lambda v: (v.scenario, v.vehicle)):
        objectives = {(v.controller, v.perception): v.metrics["objective"].mean for v in group}
        reactive, best = objectives.get(_REACTIVE), objectives.get(("mpc_preview", "oracle"))
        if reactive is None or best is None:
            continue
        for perception, entry in PERCEPTIONS.parts().items():
            objective = objectives.get(("mpc_preview", perception))
            if entry.looks_ahead and objective is not None:
                share = f"{(reactive - objective) / (reactive - best):.0%}" if reactive > best else "–"
                rows.append([f"{scenario} · {vehicle}", entry.label, f"{objective:.4f}", share])
    if len(rows) < 2:
        return ""
    shown = table(
        ["drive", "how the road is known", "J (m/s²)²", "kept of the gain over mpc_reactive"], rows, 2
    )
    return f"<section><h2>Comfort budget</h2>{scrolling(shown)}</section>"


def solver_section(runs: Sequence[Run]) -> str:
    """Counts and times of solver, fallbacks and perception for each run."""
    rows = []
    for run in runs:
        reasons, bound = (
            ", ".join(f"{name} {count}" for name, count in run.solver.get(key, {}).items())
            for key in ("reasons", "active")
        )
        rows.append(
            [
                run.case.scenario.name,
                label_of(run),
                str(run.case.seed),
                with_small(run.solver.get("solves", "–"), f"bound: {bound}" if bound else "", long=True),
                with_small(run.solver.get("fallbacks", "–"), reasons, long=True),
                *(_number(run.timing.get(name)) for name in ("median_ms", "max_ms")),
                str(run.perception_stats.get("frames", "–")),
                str(run.perception_stats.get("boxes", "–")),
                *(_number(run.timing.get(name)) for name in ("look_median_ms", "real_time_factor")),
            ]
        )
    heads = ["drive", "run", "seed", "solves", "fallbacks", _two_lines("step median", "ms")]
    heads += [_two_lines("step longest", "ms"), "exposures", "boxes"]
    heads += [_two_lines("look median", "ms"), "× real time"]
    shown = table(heads, rows, 2)
    return f"<section><h2>Solver, fallbacks, perception</h2>{scrolling(shown)}</section>"


def manifest_section(runs: Sequence[Run]) -> str:
    """Manifests of the runs, as needed to repeat them."""
    parts = []
    for run in runs:
        name = f"{run.case.scenario.name} · {label_of(run)} · seed {run.case.seed}"
        document = to_json(json.loads(to_json(manifest(run))))
        parts.append(f"<details><summary>{text(name)}</summary><pre>{escape(document)}</pre></details>")
    return f"<section><h2>Manifests</h2>{''.join(parts)}</section>"


def _effect(variant: Variant) -> Interval:
    return variant.ratio.get("objective", variant.metrics["objective"])


def _effect_name(baseline: str | None) -> str:
    return f"J / {baseline}" if baseline else "J"


def _cell(value: Interval | None, column: Column, separator: str = "") -> str:
    """Mean, and its interval in small type on a line of its own or after a separator."""
    if value is None:
        return "–"
    mean = column.shown(value.mean)
    if value.low is None or value.high is None or value.low == value.high:
        return mean
    return with_small(mean + separator, f"[{column.shown(value.low)} {column.shown(value.high)}]")


def _number(value: float | None) -> str:
    return "–" if value is None else f"{value:.3g}"


def with_small(value: object, note: str, long: bool = False) -> Html:
    """Table cell with an optional note in small type, broken into lines if it is long."""
    kind = " class=long" if long else ""
    return Html(text(value) + (f"<small{kind}>{text(note)}</small>" if note else ""))


def scrolling(content: str) -> str:
    """Region that scrolls sideways where the page is narrower than its content, and then says so."""
    hint = '<p class="hint more">Scroll sideways for more columns →</p>'
    return f'<div class="scroll" role="region" aria-label="Table">{content}</div>{hint}'


def bar_of(share: float) -> Html:
    """Horizontal bar of a table, relative to the longest one."""
    return Html(f'<span class="bar" style="width:{90 * share:.0f}px"></span>')


def _two_lines(first: str, second: str) -> Html:
    return Html(f"{text(first)}<br>{text(second)}")


def table(heads: Sequence[str], rows: Sequence[Sequence[str]], left: int) -> str:
    """HTML table of cells, escaped unless they are `Html`, with the first `left` columns left-aligned."""

    def line(cells: Sequence[str], tag: str) -> str:
        return "".join(
            f"<{tag}{' class=left' if index < left else ''}>{text(cell)}</{tag}>"
            for index, cell in enumerate(cells)
        )

    body = "".join(f"<tr>{line(cells, 'td')}</tr>" for cells in rows)
    return f"<table><thead><tr>{line(heads, 'th')}</tr></thead><tbody>{body}</tbody></table>"
