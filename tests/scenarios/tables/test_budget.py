"""Tests of the comfort budget: cost shares against hand calculation."""

import numpy as np
import pytest

from foreride.scenarios.tables.budget import SOURCES, table


def driven(**lines: list[list[float]]) -> dict[str, np.ndarray]:
    """J of each line, (seeds, events); every source costs nothing unless given."""
    done = {name: np.array(lines["whole"]) for name in SOURCES}
    return done | {name: np.array(values) for name, values in lines.items()}


def costs(row: dict) -> dict[str, float | None]:
    return {source["source"]: source["cost"] for source in row["sources"]}


def test_costs_are_shares_of_the_possible_gain() -> None:
    done = driven(
        reactive=[[0.8, 0.6], [0.8, 0.6]],
        whole=[[0.5, 0.55], [0.5, 0.57]],
        all_true=[[0.4, 0.5], [0.4, 0.5]],
        latency=[[0.42, 0.55], [0.44, 0.55]],
    )
    wide, narrow, mean = table(done, ["wide", "narrow"])
    assert [row["event"] for row in (wide, narrow, mean)] == ["wide", "narrow", "mean"]
    told = costs(wide)
    assert told.pop("latency") == pytest.approx((0.5 - 0.43) / 0.4)
    assert set(told.values()) == {0.0}
    assert wide["kept"] == pytest.approx(0.75)
    assert wide["rest"] == pytest.approx(0.25 - 0.175)
    assert costs(narrow)["latency"] == pytest.approx(0.01 / 0.1)
    assert narrow["kept"] == pytest.approx(0.4)
    assert narrow["rest"] == pytest.approx(0.6 - 0.1)
    # of means: J 0.7, 0.53 and 0.45, with latency true 0.49
    assert [mean[name] for name in ("reactive", "whole", "all_true")] == pytest.approx([0.7, 0.53, 0.45])
    assert costs(mean)["latency"] == pytest.approx(0.04 / 0.25)
    assert mean["kept"] == pytest.approx(1 - 0.08 / 0.25)
    assert mean["rest"] == pytest.approx(0.08 / 0.25 - 0.04 / 0.25)


@pytest.mark.parametrize("all_true", [0.8, 0.9])
def test_without_a_gain_there_are_no_shares_of_it(all_true: float) -> None:
    row, _ = table(driven(reactive=[[0.8]], whole=[[0.7]], all_true=[[all_true]]), ["flat"])
    assert row["kept"] is row["rest"] is None
    assert set(costs(row).values()) == {None}
    assert row["whole"] == pytest.approx(0.7)
