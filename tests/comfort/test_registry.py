"""Tests of added metrics."""

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from foreride.comfort.registry import METRICS, Column, Metric, Tolerance, added_metrics
from foreride.files.errors import InputError

SIGNALS = {"body_acc": np.array([0.0, 1.0, -3.0])}


@pytest.fixture(autouse=True)
def _restored() -> Iterator[None]:
    yield
    METRICS.unregister("peak")


def peak(function: Any, **others: Any) -> Metric:
    return Metric("peak", "m/s²", "peak of the body's acceleration", function, **others)


def test_an_added_metric_is_computed_from_the_signals() -> None:
    assert added_metrics(SIGNALS, 1000.0) == {}
    METRICS.register("peak", peak(lambda signals, rate_hz: np.abs(signals["body_acc"]).max()))
    assert added_metrics(SIGNALS, 1000.0) == {"peak": 3.0}


def spoil(signals: Any, rate_hz: float) -> float:
    signals["body_acc"][0] = 1.0
    return 0.0


@pytest.mark.parametrize(
    ("function", "told"),
    [
        (
            lambda signals, rate_hz: signals["nothing"],
            r"metric peak: fails \(KeyError: 'nothing' at test",
        ),
        (lambda signals, rate_hz: np.inf, "metric peak: must give a finite number, got inf"),
        (spoil, r"metric peak: fails \(ValueError: .*read-only at test_registry.py"),
    ],
)
def test_a_metric_that_fails_is_told_in_one_line(function: Any, told: str) -> None:
    METRICS.register("peak", peak(function))
    with pytest.raises(InputError, match=told):
        added_metrics(SIGNALS, 1000.0)
    assert SIGNALS["body_acc"][0] == 0.0


@pytest.mark.parametrize(
    ("name", "value", "told"),
    [
        ("peak", 3.0, "must be a Metric with a function, got 3.0"),
        ("peak", peak(None), "must be a Metric with a function"),
        ("top", peak(max), "must carry its own name, got 'peak'"),
        (
            "peak",
            peak(max, column=Column("peak", "m/s²", "wide")),
            "column.style must be a format",
        ),
        ("objective", peak(max), "the name is taken by foreride"),
    ],
)
def test_what_is_no_metric_is_refused(name: str, value: Any, told: str) -> None:
    with pytest.raises(InputError, match=told):
        METRICS.register(name, value)


@pytest.mark.parametrize(
    ("style", "value", "shown"),
    [(".2f", -0.004, "0.00"), (".2f", -0.006, "-0.01"), ("+.1f", -0.0, "0.0"), (".1%", -1e-9, "0.0%"),
     ("e", -0.0, "0.000000e+00"), (".0f", -12.0, "-12")],
)  # fmt: skip
def test_a_zero_is_shown_without_a_sign(style: str, value: float, shown: str) -> None:
    assert Column("c", "", style).shown(value) == shown


@pytest.mark.parametrize("metric", METRICS.parts().values(), ids=lambda metric: metric.name)
def test_no_tolerance_hides_what_a_comparison_would_show(metric: Metric) -> None:
    """Two percent of a mean or of travel, three of a peak acceleration, five of a duration."""
    of_peak, of_time = metric.name in ("crest_factor", "peak_acc"), metric.unit == "s"
    assert 0.0 < metric.tolerance.relative <= (0.05 if of_time else 0.03 if of_peak else 0.02)


def test_tolerances_are_those_that_the_documentation_states() -> None:
    """Absolute (SI) and relative; of metrics without their own, 1e-6 and 2 %."""
    own = {
        "wk_rms": (0.005, 0.01),
        "vdv": (0.02, 0.01),
        "mtvv": (0.02, 0.01),
        "crest_factor": (0.2, 0.03),
        "peak_acc": (0.2, 0.03),
        "pitch_acc_rms": (0.02, 0.02),
        "rattle_rms": (0.0002, 0.02),
        "rattle_peak": (0.001, 0.02),
        "stop_time": (0.002, 0.05),
        "tyre_load_rms": (0.003, 0.02),
        "lift_time": (0.003, 0.05),
        "damper_energy": (5.0, 0.02),
        "objective": (0.005, 0.02),
    }
    for name, metric in METRICS.own.items():
        tolerance = metric.tolerance
        assert (tolerance.absolute, tolerance.relative) == own.get(name, (1e-6, 0.02)), name
        assert metric.neutral == (name in ("crest_factor", "damper_energy"))


def test_values_are_shown_in_the_units_that_are_named() -> None:
    factors = {"mm": 1e3, "ms": 1e3}
    for metric in METRICS.own.values():
        assert metric.tolerance.factor == factors.get(metric.tolerance.unit, 1.0)
        if metric.column is not None:
            assert metric.column.factor == factors.get(metric.column.unit, 1.0)
            assert metric.column.shown(1.0) == f"{metric.column.factor:{metric.column.style}}"


@pytest.mark.parametrize(("expected", "permitted"), [(0.0, 0.5), (-10.0, 1.0), (2.0, 0.5), (40.0, 4.0)])
def test_the_larger_of_both_changes_is_permitted(expected: float, permitted: float) -> None:
    assert Tolerance(0.5, 0.1).of(expected) == pytest.approx(permitted)
