"""Section of the report that says what its numbers mean and where each is measured."""

from collections.abc import Iterator, Sequence

from foreride.comfort.registry import METRICS
from foreride.scenarios.comparison.columns import metric_columns
from foreride.scenarios.comparison.statistics import MIN_SEEDS, Variant
from foreride.scenarios.report.labels import acceleration_label
from foreride.scenarios.report.markup import text
from foreride.scenarios.simulation.simulate import Run


def glossary_section(variants: Sequence[Variant], baseline: str | None, runs: Sequence[Run]) -> str:
    """Definitions of what the tables, bars and charts of these variants and runs show."""
    pairs = "".join(
        f"<dt>{text(term)}</dt><dd>{text(meaning)}</dd>" for term, meaning in _terms(variants, baseline, runs)
    )
    return f"<section><h2>Meaning of the numbers</h2><dl>{pairs}</dl></section>"


def _terms(
    variants: Sequence[Variant], baseline: str | None, runs: Sequence[Run]
) -> Iterator[tuple[str, str]]:
    weights = {f"{run.case.scenario.tyre_load_weight:g}" for run in runs}
    rho = f", with rho = {', '.join(sorted(weights))} (m/s²)²" if weights else ""
    yield "J", f"objective, (Wk RMS)² + rho · (tyre load RMS)²{rho}; less is better"
    if baseline:
        yield f"J / {baseline}", f"J relative to {baseline} with the same seed"
    if any(variant.captured for variant in variants):
        yield (
            "captured",
            "share of the possible reduction of J: 0 % is the passive car, 100 % the bound, the optimum of a "
            "controller that knows the whole road",
        )
    metrics = METRICS.parts()
    for name, column in metric_columns():
        yield column.name, metrics[name].meaning
    yield "fallbacks", "control steps that a simpler law took over, as the solver or its input failed"
    seats = {acceleration_label(run.case.scenario.vehicle.parameters) for run in runs}
    if runs:
        yield (
            "charts",
            f"{' or '.join(sorted(seats))}, unweighted, and the damper of one wheel; the table judges all "
            "seats and wheels",
        )
    yield (
        "[low high]",
        f"95 % bootstrap interval of the mean over seeds, from {MIN_SEEDS} seeds on; none where the seed "
        "changes nothing",
    )
