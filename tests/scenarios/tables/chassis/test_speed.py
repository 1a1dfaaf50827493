"""The speed study: means of rows, equal times, the figure's fronts."""

from typing import Any

import numpy as np

from foreride.scenarios.report.figures.files import encoded
from foreride.scenarios.report.figures.speed import speed_figure
from foreride.scenarios.tables.chassis.speed import front, policy_table, ratio, times
from foreride.scenarios.tables.chassis.speed_drives import (
    CRUISE,
    POLICIES,
    Group,
    driven_group,
    key_of,
)


def metrics(trip_s: float, wk2: float, x2: float = 0.0) -> dict[str, float]:
    return {"trip_s": trip_s, "wk2": wk2, "x2": x2, "load2": 0.0, "deceleration": 2.0, "least_kmh": 20.0}


def row(event: int, wk2: float) -> dict[str, Any]:
    policies = {CRUISE: metrics(10.0, 4.0), "preview 1": metrics(12.0, wk2, 0.44)}
    equal = {"preview 1": metrics(12.0, 2.25)}
    names = {"event": event, "seed": 0, "controller": "passive", "perception": "oracle"}
    return {**names, "policies": policies, "equal time": equal}


def test_rides_are_compared_over_the_same_road_and_at_the_same_time() -> None:
    rows = [row(0, 1.0), row(1, 1.0)]
    np.testing.assert_allclose(times(rows, "preview 1"), 1.2)
    np.testing.assert_allclose(ratio(rows, "preview 1", {"wk2": 1.0}), 0.5)
    np.testing.assert_allclose(ratio(rows, "preview 1", {"wk2": 1.0, "x2": 1.0}), 0.6)
    np.testing.assert_allclose(ratio(rows, "preview 1", {"wk2": 1.0}, True), 2.0 / 3.0)
    table = policy_table(rows)
    assert table[2].startswith(f"| {CRUISE} | 1.000 | 1.000 |")
    assert table[3] == "| preview 1 | 1.200 | 0.500 | 0.600 | 0.500 | 0.667 | 0.800 | 0.667 | 2.0 |"
    points = front(rows)
    np.testing.assert_allclose(points["preview planner"], [[1.0, 1.0], [1.2, 0.6]])
    np.testing.assert_allclose(points["constant speed"], [[1.0, 1.0], [1.2, 0.75]])
    assert next(encoded(speed_figure({"passive": points}), ("png",))).startswith(b"\x89PNG")


def test_a_group_drives_each_policy_and_a_constant_speed_that_takes_as_long() -> None:
    group = Group(3, 0, "passive", "none")
    name = next(policy for policy in POLICIES if policy.startswith("reactive"))
    found = driven_group(group, [], [name])
    assert key_of(found) == group
    slow, constant = found["policies"][name], found["equal time"][name]
    assert slow["trip_s"] > found["policies"][CRUISE]["trip_s"]
    assert abs(slow["trip_s"] - constant["trip_s"]) < 0.01
