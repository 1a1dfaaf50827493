"""Tables of the HTML report."""

import json
from collections.abc import Sequence
from html import escape
from itertools import groupby

from foreride.scenarios.comparison.statistics import Interval, Variant
from foreride.scenarios.comparison.table import columns, short_name
from foreride.scenarios.perceptions.registry import PERCEPTIONS
from foreride.scenarios.report.labels import label_of
from foreride.scenarios.report.markup import Html, text
from foreride.scenarios.runs.write import manifest, to_json
from foreride.scenarios.simulation.simulate import Run

_REACTIVE = ("mpc_reactive", "none")


def metrics_section(variants: Sequence[Variant], baseline: str | None) -> str:
    """Means with confidence intervals, one table per scenario; a bar shows J relative to the baseline."""
    tables = []
    for (scenario, vehicle), group in groupby(variants, key=lambda v: (v.scenario, v.vehicle)):
        members = list(group)
        captured = any(v.captured for v in members)
        effect = f"J / {baseline}" if baseline else "J"
        heads: list[str] = ["controller", "preview", "", effect, *(["captured"] if captured else [])]
        heads += [_two_lines(c.name, c.unit) for _, c in columns()] + ["fallbacks", "seeds"]
        maximum = max(_effect(v).mean for v in members) or 1.0
        rows = []
        for v in members:
            bar = bar_of(_effect(v).mean / maximum)
            row: list[str] = [short_name(v.controller), v.perception, bar, _cell(_effect(v), ".3f")]
            row += [_cell(v.captured, ".1%")] if captured else []
            row += [_cell(v.metrics.get(name), c.style, c.factor) for name, c in columns()]
            rows.append([*row, str(v.fallbacks), str(len(v.seeds))])
        tables.append(f"<h2>{text(scenario)} · {text(vehicle)}</h2>{table(heads, rows, left=2)}")
    note = "Means over seeds with 95 % bootstrap intervals (three seeds or more); effects are paired by seed."
    return f'<section><div class="scroll">{"".join(tables)}</div><p class="hint">{note}</p></section>'


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
    return f'<section><h2>Comfort budget</h2><div class="scroll">{shown}</div></section>'


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
                with_small(run.solver.get("solves", "–"), f"bound: {bound}" if bound else ""),
                with_small(run.solver.get("fallbacks", "–"), reasons),
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
    return f'<section><h2>Solver, fallbacks, perception</h2><div class="scroll">{shown}</div></section>'


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


def _cell(value: Interval | None, style: str, factor: float = 1.0) -> str:
    if value is None:
        return "–"
    mean = format(value.mean * factor, style)
    if value.low is None or value.high is None or value.low == value.high:
        return mean
    return with_small(mean, f"{format(value.low * factor, style)} … {format(value.high * factor, style)}")


def _number(value: float | None) -> str:
    return "–" if value is None else f"{value:.3g}"


def with_small(value: object, note: str) -> Html:
    """Table cell with an optional note in small type."""
    return Html(text(value) + (f"<small>{text(note)}</small>" if note else ""))


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
