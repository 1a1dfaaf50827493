"""Tables of the HTML report."""

import json
from collections.abc import Sequence
from html import escape
from itertools import groupby

from scenarios.closed_loop import Run
from scenarios.report.figures import label_of
from scenarios.report.table import COLUMNS, Column, short_name
from scenarios.runfolder import manifest, to_json
from scenarios.statistics import Interval, Variant

_REACTIVE = ("mpc_reactive", "none")
_LADDER = {
    "oracle": "true road",
    "map": "map of the road",
    "boxes": "true boxes with errors",
    "camera": "camera and detector",
}


def metrics_section(variants: Sequence[Variant], baseline: str | None) -> str:
    """Means with confidence intervals, one table per scenario; a bar shows J relative to the baseline."""
    tables = []
    for (scenario, vehicle), group in groupby(variants, key=lambda v: (v.scenario, v.vehicle)):
        members = list(group)
        captured = any(v.captured for v in members)
        effect = f"J / {escape(baseline)}" if baseline else "J"
        heads = ["controller", "preview", "", effect, *(["captured"] if captured else [])]
        heads += [f"{c.name}<br>{c.unit}" for c in COLUMNS] + ["fallbacks", "seeds"]
        most = max(_effect(v).mean for v in members) or 1.0
        rows = []
        for v in members:
            bar = f'<span class="bar" style="width:{90 * _effect(v).mean / most:.0f}px"></span>'
            row = [escape(short_name(v.controller)), escape(v.perception), bar, _cell(_effect(v), ".3f")]
            row += [_cell(v.captured, ".1%")] if captured else []
            row += [_metric(v, c) for c in COLUMNS]
            rows.append([*row, str(v.fallbacks), str(len(v.seeds))])
        tables.append(f"<h2>{escape(scenario)} · {escape(vehicle)}</h2>{table(heads, rows, left=2)}")
    told = "Means over seeds with 95 % bootstrap intervals (three seeds or more); effects are paired by seed."
    return f'<section><div class="scroll">{"".join(tables)}</div><p class="hint">{told}</p></section>'


def budget_section(variants: Sequence[Variant]) -> str:
    """Fraction of the possible gain of preview over the reactive MPC that each perception keeps."""
    rows = []
    for (scenario, vehicle), group in groupby(variants, key=lambda v: (v.scenario, v.vehicle)):
        found = {(v.controller, v.perception): v.metrics["objective"].mean for v in group}
        reactive, best = found.get(_REACTIVE), found.get(("mpc_preview", "oracle"))
        if reactive is None or best is None:
            continue
        for perception, told in _LADDER.items():
            if (objective := found.get(("mpc_preview", perception))) is not None:
                share = f"{(reactive - objective) / (reactive - best):.0%}" if reactive > best else "–"
                rows.append([escape(f"{scenario} · {vehicle}"), told, f"{objective:.4f}", share])
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
            ", ".join(f"{name} {count}" for name, count in run.solver.get(told, {}).items())
            for told in ("reasons", "active")
        )
        rows.append(
            [
                escape(run.case.scenario.name),
                escape(label_of(run)),
                str(run.case.seed),
                str(run.solver.get("solves", "–"))
                + (f"<small>bound: {escape(bound)}</small>" if bound else ""),
                str(run.solver.get("fallbacks", "–"))
                + (f"<small>{escape(reasons)}</small>" if reasons else ""),
                *(_number(run.timing.get(name)) for name in ("median_ms", "max_ms")),
                str(run.perception_stats.get("frames", "–")),
                str(run.perception_stats.get("boxes", "–")),
                *(_number(run.timing.get(name)) for name in ("look_median_ms", "real_time_factor")),
            ]
        )
    heads = ["drive", "run", "seed", "solves", "fallbacks", "step median<br>ms", "step longest<br>ms"]
    heads += ["exposures", "boxes", "look median<br>ms", "× real time"]
    shown = table(heads, rows, 2)
    return f'<section><h2>Solver, fallbacks, perception</h2><div class="scroll">{shown}</div></section>'


def manifest_section(runs: Sequence[Run]) -> str:
    """Manifests of the runs, as needed to repeat them."""
    parts = []
    for run in runs:
        name = f"{run.case.scenario.name} · {label_of(run)} · seed {run.case.seed}"
        text = to_json(json.loads(to_json(manifest(run))))
        parts.append(f"<details><summary>{escape(name)}</summary><pre>{escape(text)}</pre></details>")
    return f"<section><h2>Manifests</h2>{''.join(parts)}</section>"


def _effect(variant: Variant) -> Interval:
    return variant.ratio.get("objective", variant.metrics["objective"])


def _metric(variant: Variant, column: Column) -> str:
    return _cell(variant.metrics[column.metric], column.style, column.factor)


def _cell(value: Interval | None, style: str, factor: float = 1.0) -> str:
    if value is None:
        return "–"
    text = format(value.mean * factor, style)
    if value.low is None or value.high is None or value.low == value.high:
        return text
    return f"{text}<small>{format(value.low * factor, style)} … {format(value.high * factor, style)}</small>"


def _number(value: float | None) -> str:
    return "–" if value is None else f"{value:.3g}"


def table(heads: Sequence[str], rows: Sequence[Sequence[str]], left: int) -> str:
    """HTML table of cells that are already HTML, with the first `left` columns left-aligned."""

    def line(cells: Sequence[str], tag: str) -> str:
        return "".join(
            f"<{tag}{' class=left' if index < left else ''}>{cell}</{tag}>"
            for index, cell in enumerate(cells)
        )

    body = "".join(f"<tr>{line(cells, 'td')}</tr>" for cells in rows)
    return f"<table><thead><tr>{line(heads, 'th')}</tr></thead><tbody>{body}</tbody></table>"
