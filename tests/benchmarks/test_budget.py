"""Shares of the comfort budget, counted by hand."""

import numpy as np
import pytest

from benchmarks.tables.budget import SOURCES, table


def test_costs_are_shares_of_the_possible_gain() -> None:
    j = {name: np.full((2, 1), 0.5) for name in SOURCES}
    j["latency"] = np.array([[0.42], [0.44]])
    done = {
        "reactive": np.full((2, 1), 0.8),
        "whole": np.full((2, 1), 0.5),
        "all_true": np.full((2, 1), 0.4),
        **j,
    }
    row, mean = table(done, ["a"])
    costs = {source["source"]: source["cost"] for source in row["sources"]}
    assert costs.pop("latency") == pytest.approx((0.5 - 0.43) / 0.4)
    assert set(costs.values()) == {0.0}
    assert row["kept"] == pytest.approx(0.75)
    assert row["rest"] == pytest.approx(0.25 - 0.175)
    assert mean | {"event": "a"} == row
