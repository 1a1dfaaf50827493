"""Results over random roads: paired means, shares of a gain, and intervals by event and seed."""

import numpy as np
import pytest

from foreride.scenarios.random_roads.drives import Line
from foreride.scenarios.random_roads.results import collected, interval, mean, share_kept, worse

PASSIVE, LAW = Line("passive", "none"), Line("skyhook", "none")


def test_values_are_relative_to_passive_on_the_same_event_and_seed() -> None:
    rows = [
        {"event": event, "seed": seed, **line._asdict(), "metrics": {"objective": value * (1 + event + seed)}}
        for line, value in ((PASSIVE, 2.0), (LAW, 1.0))
        for event in (5, 6)
        for seed in (0, 1, 2)
    ]
    results = collected(rows[::-1], [PASSIVE, LAW], [5, 6], [0, 1, 2])
    np.testing.assert_array_equal(results.relative(LAW), np.full((2, 3), 0.5))
    assert results.of_line[LAW]["objective"][1, 2] == 9.0


def test_a_bootstrap_over_events_is_as_wide_as_events_differ() -> None:
    values = np.random.default_rng(0).normal(1.0, 0.2, size=(100, 1)) + np.zeros((1, 3))
    found = interval(mean, values)
    assert found.low is not None
    assert found.high is not None
    width = found.high - found.low
    assert width == pytest.approx(2 * 1.96 * values.std() / 10.0, rel=0.15)
    assert interval(mean, values[:2]).low is None


def test_a_share_is_paired_between_lines() -> None:
    rival = np.random.default_rng(1).uniform(0.4, 0.8, (40, 1))
    found = interval(share_kept, rival, rival - 0.05, rival - 0.1)
    assert [found.mean, found.low, found.high] == pytest.approx([0.5] * 3)


def test_worse_counts_events_by_their_mean_over_seeds() -> None:
    rival = np.ones((3, 2))
    assert worse(np.array([[1.005, 1.005], [0.9, 1.2], [1.5, 0.4]]), rival) == 1
