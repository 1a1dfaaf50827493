"""Comparison tables for publications: Markdown and LaTeX, with caption and notes."""

import re
from collections.abc import Sequence

from foreride.files.errors import printable
from foreride.scenarios.cases import Case
from foreride.scenarios.comparison.columns import UNCHANGED, columns_of
from foreride.scenarios.comparison.statistics import MIN_SEEDS, Variant
from foreride.scenarios.comparison.table import HEADS, short_name
from foreride.scenarios.perceptions.registry import PERCEPTIONS
from foreride.scenarios.runs.record import vehicle_name

_OBSERVERS = {
    "truth": "the true state of the car",
    "sensors": "the state that a Kalman observer estimates from noisy sensors",
}
_UNCHANGED_NOTE = f"{UNCHANGED}: every seed gives the same value, as nothing random acts on it."


def caption(cases: Sequence[Case], baseline: str | None = None) -> str:
    """Conditions of the drives, and the meaning of the numbers, as sentences."""
    cars = _listed(
        f"{case.scenario.vehicle.parameters.kind.replace('_', ' ')} ({vehicle_name(case.scenario)})"
        for case in cases
    )
    observers = _listed(_OBSERVERS[case.scenario.observer] for case in cases)
    entries = PERCEPTIONS.parts()
    previews = _listed(
        f"{case.perception} ({entries[case.perception].label})" for case in cases if case.perception != "none"
    )
    seeds = sorted({case.seed for case in cases})
    sentences = [f"Vehicle: {cars}", f"Controllers are given {observers}"]
    sentences += [f"Preview: {previews}"] if previews else []
    sentences.append(f"{'Seed' if len(seeds) == 1 else 'Means over the seeds'} {_ranges(seeds)}")
    if len(seeds) >= MIN_SEEDS:
        sentences.append("In brackets: 95 % bootstrap confidence interval of the mean over the seeds")
    elif len(seeds) > 1:
        sentences.append(f"No confidence intervals, which need {MIN_SEEDS} seeds")
    sentences.append("J is the objective, less is better")
    if baseline:
        sentences.append(f"Ratios are to {short_name(baseline)} with the same seed")
    return ". ".join(sentences) + "."


def cells(
    variants: Sequence[Variant], baseline: str | None = None, keys: Sequence[str] | None = None
) -> tuple[list[str], list[list[str]]]:
    """Heads and rows of a table, every number with its interval."""
    columns = columns_of(variants, baseline, keys)
    rows = [
        [variant.scenario, short_name(variant.controller), variant.perception]
        + [column.cell(variant, spread=True) for column in columns]
        for variant in variants
    ]
    return [*HEADS, *(column.head for column in columns)], rows


def markdown(
    variants: Sequence[Variant],
    baseline: str | None = None,
    keys: Sequence[str] | None = None,
    text: str = "",
) -> str:
    """Comparison as a Markdown table (GitHub's pipes) under its caption `text`."""
    heads, rows = cells(variants, baseline, keys)
    align = ["---"] * len(HEADS) + ["---:"] * (len(heads) - len(HEADS))
    lines = [f"| {' | '.join(map(_markdown_cell, row))} |" for row in (heads, align, *rows)]
    above = [_markdown_cell(text), ""] if text else []
    below = ["", _UNCHANGED_NOTE] if _has_unchanged(rows) else []
    return "\n".join([*above, *lines, *below]) + "\n"


def latex(
    variants: Sequence[Variant],
    baseline: str | None = None,
    keys: Sequence[str] | None = None,
    text: str = "",
) -> str:
    """Comparison as a LaTeX table with caption `text`; needs the package booktabs."""
    heads, rows = cells(variants, baseline, keys)
    note = [rf"\par\smallskip\footnotesize {_tex(_UNCHANGED_NOTE)}"] if _has_unchanged(rows) else []
    lines = [
        "% \\usepackage{booktabs}",
        r"\begin{table}",
        r"\centering",
        *([rf"\caption{{{_tex(text)}}}"] if text else []),
        rf"\begin{{tabular}}{{{'l' * len(HEADS)}{'r' * (len(heads) - len(HEADS))}}}",
        r"\toprule",
        _tex_row(heads),
        r"\midrule",
        *(_tex_row(row) for row in rows),
        r"\bottomrule",
        r"\end{tabular}",
        *note,
        r"\end{table}",
    ]
    return "\n".join(lines) + "\n"


def _listed(names: object) -> str:
    return ", ".join(dict.fromkeys(names))  # type: ignore[call-overload]


def _ranges(numbers: Sequence[int]) -> str:
    """Ascending numbers with runs of three and more abbreviated: `0, 3–5`."""
    runs: list[list[int]] = []
    for number in numbers:
        if runs and number == runs[-1][-1] + 1:
            runs[-1].append(number)
        else:
            runs.append([number])
    return ", ".join(f"{run[0]}–{run[-1]}" if len(run) > 2 else ", ".join(map(str, run)) for run in runs)


def _has_unchanged(rows: Sequence[Sequence[str]]) -> bool:
    return any(cell.endswith(UNCHANGED) for row in rows for cell in row)


def _markdown_cell(cell: str) -> str:
    return printable(cell).replace("\\", "\\\\").replace("|", "\\|").replace("<", "&lt;")


_TEX = {"\\": r"\textbackslash{}", "²": "$^2$", "^": r"\^{}", "~": r"\textasciitilde{}", "–": "--"} | {
    letter: f"\\{letter}" for letter in "_%&#${}"
}


def _tex(text: str) -> str:
    """Text with LaTeX's special characters escaped, and exponents raised."""
    parts = re.split(r"\^([0-9.]+)", printable(text))
    plain = ("".join(_TEX.get(letter, letter) for letter in part) for part in parts[::2])
    raised = (f"$^{{{exponent}}}$" for exponent in parts[1::2])
    return "".join(word for pair in zip(plain, [*raised, ""], strict=True) for word in pair)


def _tex_row(row: Sequence[str]) -> str:
    return " & ".join(map(_tex, row)) + r" \\"
