"""Pareto fronts: efficient points, and the share of the box that they dominate."""

import numpy as np
import pytest

from foreride.scenarios.random_roads.drives import Line
from foreride.scenarios.random_roads.events import event_scenario
from foreride.scenarios.random_roads.fronts import (
    METRICS,
    REFERENCE,
    efficient,
    front_lines,
    hypervolume,
    points,
)
from foreride.scenarios.random_roads.results import Results


def test_efficient_points_are_those_that_no_other_one_dominates() -> None:
    values = np.array([[0.5, 0.9], [0.6, 0.6], [0.7, 0.8], [0.6, 0.6], [0.9, 0.5]])
    np.testing.assert_array_equal(efficient(values), [True, True, False, True, True])


def test_the_hypervolume_is_that_of_the_union_of_boxes() -> None:
    assert hypervolume(REFERENCE * np.array([[0.5, 0.5]])) == pytest.approx(0.25)
    assert hypervolume(REFERENCE * np.array([[0.5, 0.8], [0.8, 0.5]])) == pytest.approx(0.1 + 0.1 - 0.04)
    assert hypervolume(np.array([[0.5, 1.3]])) == 0.0
    assert hypervolume(np.array([[1.0, 1.0, 1.0]])) == pytest.approx(0.2**3)
    rng = np.random.default_rng(0)
    values, samples = rng.uniform(0.3, 1.1, (7, 3)), rng.uniform(0.0, 1.0, (100_000, 3))
    sampled = (values[None] <= samples[:, None]).all(axis=2).any(axis=1).mean()
    assert hypervolume(REFERENCE * values) == pytest.approx(sampled, abs=0.005)


def test_every_setting_of_a_front_is_a_valid_override() -> None:
    controllers = ["passive", "skyhook", "hybrid", "lqr_clipped", "mpc_preview"]
    lines = front_lines(controllers, ["oracle"], limits=True)
    assert lines[0] == Line("passive", "none")
    settings = [event_scenario(0, [line.condition]).control.settings for line in lines[1:]]
    assert len(set(map(repr, settings))) >= len(lines) - 4  # each controller has its tuned one at most once


def test_soft_limits_are_a_front_of_their_own() -> None:
    lines = front_lines(["passive", "skyhook", "mpc_reactive"], ["oracle"], limits=True)
    of_line = {line: {name: np.ones((1, 1)) for name in METRICS} for line in lines}
    fronts = points(Results((0,), of_line))
    assert [*fronts] == ["passive", "skyhook", "mpc_reactive", "mpc_reactive (limits)"]
    assert len(fronts["mpc_reactive (limits)"][0]) == 4


def test_points_are_relative_to_the_passive_car_without_settings() -> None:
    passive, soft, hard = Line("passive", "none"), *front_lines(["skyhook"], ["oracle"])[:2]
    of_line = {
        line: {name: np.full((2, 1), level) for name in METRICS}
        for line, level in ((passive, 2.0), (soft, 1.0), (hard, 1.5))
    }
    conditions, values = points(Results((0, 1), of_line))["skyhook"]
    assert conditions == [soft.condition, hard.condition]
    np.testing.assert_allclose(values, [[0.5] * 3, [0.75] * 3])
