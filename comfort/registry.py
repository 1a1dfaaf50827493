"""Registry of ride metrics: unit, meaning, tolerance of a regression check, and column in tables."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from foreride.files.errors import InputError, shown
from foreride.files.own_code import error_text
from foreride.files.plugins import Registry

Signals = Mapping[str, np.ndarray]
"""Signals of a run, one value per tick, under the names of its `signals.parquet`; read-only."""


@dataclass(frozen=True)
class Tolerance:
    """Permitted change of a metric: the larger of `absolute` (SI) and `relative`; shown times `factor`."""

    absolute: float
    relative: float = 0.0
    unit: str = ""
    factor: float = 1.0

    def of(self, expected: float) -> float:
        """Permitted change about a baseline value."""
        return max(self.absolute, self.relative * abs(expected))


@dataclass(frozen=True)
class Column:
    """Column of a metric in tables: heading, unit, format and factor."""

    name: str
    unit: str
    style: str = ".3f"
    factor: float = 1.0

    def shown(self, value: float) -> str:
        """Value (SI) as the column shows it, a zero without a sign."""
        text = format(value * self.factor, self.style)
        return text if set(text) & set("123456789") else text.replace("-", "")


DEFAULT_TOLERANCE = Tolerance(1e-6, 0.02)


@dataclass(frozen=True)
class Metric:
    """Ride metric.

    function(signals, rate_hz): its value, SI, from the `Signals` of a run; None for those that
    `comfort.metrics` computes together. tolerance: see `foreride regress`. column: None for none in tables.
    neutral: a change is reported but is no loss of comfort or safety; otherwise less is better.
    """

    name: str
    unit: str
    meaning: str
    function: Callable[[Signals, float], float] | None = None
    tolerance: Tolerance = DEFAULT_TOLERANCE
    column: Column | None = None
    neutral: bool = False

    @property
    def definition(self) -> str:
        """Unit and meaning."""
        return f"{self.unit}: {self.meaning}" if self.unit else self.meaning


_OWN = (
    Metric(
        "wk_rms",
        "m/s²",
        "root of the mean over seats of the squared Wk-weighted RMS of vertical acceleration",
        tolerance=Tolerance(0.005, 0.01, "m/s²"),
        column=Column("Wk RMS", "m/s²"),
    ),
    Metric(
        "vdv",
        "m/s^1.75",
        "vibration dose value, Wk, worst seat",
        tolerance=Tolerance(0.02, 0.01, "m/s^1.75"),
        column=Column("VDV", "m/s^1.75", ".2f"),
    ),
    Metric("evdv", "m/s^1.75", "estimated vibration dose value, Wk, worst seat"),
    Metric(
        "mtvv",
        "m/s²",
        "maximum transient vibration value (1 s), Wk, worst seat",
        tolerance=Tolerance(0.02, 0.01, "m/s²"),
    ),
    Metric("crest_factor", "", "peak over RMS, Wk, worst seat", tolerance=Tolerance(0.2, 0.03), neutral=True),
    Metric("vibration_total", "m/s²", "overall vibration total value of ISO 2631-1, 12 axes, worst seat"),
    Metric(
        "peak_acc",
        "m/s²",
        "peak vertical acceleration of any seat, unweighted",
        tolerance=Tolerance(0.2, 0.03, "m/s²"),
        column=Column("peak acc.", "m/s²", ".2f"),
    ),
    Metric(
        "pitch_acc_rms",
        "rad/s²",
        "RMS, unweighted; 0 without pitch",
        tolerance=Tolerance(0.02, 0.02, "rad/s²"),
    ),
    Metric("roll_acc_rms", "rad/s²", "RMS, unweighted; 0 without roll"),
    Metric(
        "rattle_rms",
        "m",
        "RMS suspension travel from equilibrium, over all wheels",
        tolerance=Tolerance(0.0002, 0.02, "mm", 1e3),
    ),
    Metric(
        "rattle_peak",
        "m",
        "peak suspension travel from equilibrium of any wheel",
        tolerance=Tolerance(0.001, 0.02, "mm", 1e3),
        column=Column("rattle peak", "mm", ".0f", 1e3),
    ),
    Metric(
        "stop_time",
        "s",
        "time during which any wheel is on a bump or rebound stop",
        tolerance=Tolerance(0.002, 0.05, "ms", 1e3),
        column=Column("stops", "ms", ".0f", 1e3),
    ),
    Metric(
        "tyre_load_rms",
        "",
        "RMS over wheels (hence over axles) of dynamic / static tyre load",
        tolerance=Tolerance(0.003, 0.02),
        column=Column("tyre load", "RMS"),
    ),
    Metric(
        "tyre_load_p95",
        "",
        "95th percentile over time of the magnitude of dynamic / static tyre load, worst wheel",
    ),
    Metric(
        "lift_time",
        "s",
        "time during which any wheel carries no load",
        tolerance=Tolerance(0.003, 0.05, "ms", 1e3),
        column=Column("lift", "ms", ".0f", 1e3),
    ),
    Metric(
        "damper_energy",
        "J",
        "energy dissipated by all dampers",
        tolerance=Tolerance(5.0, 0.02, "J"),
        neutral=True,
    ),
    Metric("damper_power_peak", "W", "peak power absorbed by any damper"),
    Metric(
        "objective",
        "(m/s²)²",
        "wk_rms² + rho tyre_load_rms²",
        tolerance=Tolerance(0.005, 0.02, "(m/s²)²"),
    ),
)


def _accept(name: str, value: Any) -> Metric:
    """The value, if it is a metric that can be computed and shown."""
    if not isinstance(value, Metric) or not callable(value.function):
        raise InputError(f"must be a Metric with a function, got {shown(value)}")
    if value.name != name:
        raise InputError(f"must carry its own name, got {shown(value.name)}")
    try:
        if value.column is not None:
            format(value.column.factor, value.column.style)
    except (TypeError, ValueError) as error:
        raise InputError(f"column.style must be a format of numbers ({error})") from None
    return value


METRICS: Registry[Metric] = Registry(
    "foreride.metrics", "metric", {metric.name: metric for metric in _OWN}, _accept
)


def added_metrics(signals: Mapping[str, np.ndarray], rate_hz: float) -> dict[str, float]:
    """Values of the metrics that packages and users have added, from the signals of a run.

    Raises InputError, naming the metric, if its function fails or gives no finite number.
    """
    added = {name: metric for name, metric in METRICS.parts().items() if metric.function is not None}
    if not added:
        return {}
    views = {name: values.view() for name, values in signals.items()}
    for view in views.values():
        view.flags.writeable = False
    return {name: _value(metric, views, rate_hz) for name, metric in added.items()}


def _value(metric: Metric, signals: Signals, rate_hz: float) -> float:
    assert metric.function is not None
    code = getattr(metric.function, "__code__", None)
    try:
        value = float(metric.function(signals, rate_hz))
    except KeyboardInterrupt:
        raise
    except BaseException as error:  # user code may raise anything, even SystemExit
        told = error_text(error, Path(code.co_filename if code else ""))
        raise InputError(f"metric {metric.name}: fails ({told})") from error
    if not np.isfinite(value):
        raise InputError(f"metric {metric.name}: must give a finite number, got {value!r}")
    return value
