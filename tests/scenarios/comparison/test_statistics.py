"""Tests of means, confidence intervals and paired effects against textbook values and synthetic rows."""

import numpy as np
import pytest
from scipy.stats import norm

from foreride.files.errors import InputError
from foreride.scenarios.comparison.statistics import Interval, captured, intervals, pick, summarise


def row(controller: str, seed: int, objective: float, perception: str = "none", lift: float = 0.0) -> dict:
    metrics = {"objective": objective, "lift_time": lift}
    names = {"scenario": "bump", "vehicle": "half", "controller": controller, "perception": perception}
    return names | {"seed": seed, "metrics": metrics, "solver": {"fallbacks": seed}}


def rows() -> list[dict]:
    """Rows in which the passive car varies strongly with the seed; the others are about 0.8 and 0.5 of it."""
    found = []
    for seed, passive in enumerate((1.0, 2.0, 4.0, 3.0)):
        found.append(row("passive", seed, passive))
        found.append(row("mpc_preview", seed, passive * (0.8 + 0.01 * seed), "oracle"))
        found.append(row("clairvoyant", seed, 0.5 * passive, lift=0.01 * seed))
    return found


def test_the_interval_of_many_normal_values_is_the_textbook_one() -> None:
    values = np.random.default_rng(7).normal(5.0, 2.0, 400)
    (found,) = intervals(values[None])
    half = norm.ppf(0.975) * values.std(ddof=1) / np.sqrt(len(values))
    assert found.mean == pytest.approx(values.mean())
    assert found.low == pytest.approx(values.mean() - half, abs=0.05 * half)
    assert found.high == pytest.approx(values.mean() + half, abs=0.05 * half)


def test_few_values_have_no_interval_and_equal_ones_a_point() -> None:
    assert intervals(np.array([[1.0, 2.0]])) == [Interval(1.5)]
    assert intervals(np.array([[3.0, 3.0, 3.0]])) == [Interval(3.0, 3.0, 3.0)]


def test_effects_are_paired_by_seed() -> None:
    """The variation between seeds, common to both cars, does not widen the interval of the effect."""
    preview = summarise(rows(), "passive")[1]
    own, effect = preview.metrics["objective"], preview.ratio["objective"]
    assert effect.mean == pytest.approx(np.mean([0.80, 0.81, 0.82, 0.83]))
    assert 0.80 <= effect.low < effect.mean < effect.high <= 0.83
    assert own.high - own.low > 1.0
    assert preview.difference["objective"].mean == pytest.approx(-np.mean([0.2, 0.38, 0.72, 0.51]))


def test_a_metric_that_is_zero_for_the_baseline_has_a_difference_but_no_ratio() -> None:
    bound = summarise(rows(), "passive")[2]
    assert "lift_time" not in bound.ratio
    assert bound.difference["lift_time"].mean == pytest.approx(0.015)


def test_captured_is_the_share_of_what_the_bound_wins() -> None:
    passive, preview, bound = summarise(rows(), "passive")
    assert passive.captured.mean == 0.0
    assert bound.captured.mean == 1.0
    assert preview.captured.mean == pytest.approx(np.mean([0.40, 0.38, 0.36, 0.34]))
    assert summarise([r for r in rows() if r["controller"] != "clairvoyant"], "passive")[1].captured is None


def test_captured_needs_no_run_of_the_bound_where_the_rows_tell_it_and_no_certain_baseline() -> None:
    told = [
        one | {"bound": {"objective": 0.5, "passive_objective": 1.0, "gap_between_starts": 0.0}}
        for one in (row("skyhook", 0, 0.9), row("mpc_preview", 0, 0.6, "oracle"))
    ]
    for baseline in (None, "skyhook"):
        assert [line.captured.mean for line in summarise(told, baseline)] == pytest.approx([0.2, 0.8])
    assert captured(1.0, 1.0, 0.6) == 0.0
    assert captured(0.7, 1.0, 0.6) == pytest.approx(0.75)


def test_the_same_rows_give_the_same_intervals() -> None:
    assert summarise(rows(), "passive") == summarise(rows(), "passive")


def test_fallbacks_add_up() -> None:
    assert summarise(rows())[0].fallbacks == 6


@pytest.mark.parametrize("name", ["mpc_previw", "mpc_preview", "mpc_preview@camera"])
def test_a_baseline_that_did_not_run_or_is_ambiguous_is_refused(name: str) -> None:
    ran = [("passive", "none"), ("mpc_preview", "oracle"), ("mpc_preview", "boxes")]
    with pytest.raises(InputError, match="mpc_preview@oracle, mpc_preview@boxes"):
        pick(name, ran)
    assert pick("mpc_preview@boxes", ran) == ran[2]
