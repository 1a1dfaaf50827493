"""Tests of the controller statistics."""

import numpy as np
import pytest

from foreride.controller.supervision import step_statistics
from foreride.controller.supervision.step_statistics import ControllerStatistics


def test_steps_are_counted_and_timed_in_milliseconds(monkeypatch: pytest.MonkeyPatch) -> None:
    """Three steps of 2, 3 and 7 ms by a clock of our own, the last one a fallback."""
    times = iter([10.0, 10.002, 20.0, 20.003, 30.0, 30.007])
    monkeypatch.setattr(step_statistics, "perf_counter", lambda: next(times))
    statistics = ControllerStatistics()
    for problem, active in ((None, ("rate",)), (None, ("rate", "power")), ("infeasible", ())):
        statistics.start()
        statistics.finish(problem, active)
    summary = statistics.summary()
    assert (summary["solves"], summary["fallbacks"], summary["reasons"]) == (2, 1, {"infeasible": 1})
    assert summary["active"] == {"power": 1, "rate": 2}
    np.testing.assert_allclose([summary["median_ms"], summary["max_ms"]], [3.0, 7.0], rtol=1e-9)
    assert (statistics.problem, statistics.active) == ("infeasible", ())


def test_before_the_first_step_there_are_no_times() -> None:
    summary = ControllerStatistics().summary()
    assert (summary["solves"], summary["median_ms"], summary["max_ms"]) == (0, None, None)
