"""The braking study: its drives brake as stated, and its table holds differences to the passive car."""

import numpy as np
import pytest

from foreride.scenarios.tables.chassis.braking import (
    BEFORE_M,
    DECELERATION_M_S2,
    Stop,
    braking_scenario,
    driven_stop,
    stopping_table,
)


def test_the_car_brakes_to_a_crawl_on_the_rough_road() -> None:
    scenario = braking_scenario(Stop(3, 0, "passive", "C", 0.0))
    motion = scenario.motion
    assert not isinstance(motion, float)
    speeds, times = motion.speeds_m_s, motion.times_s
    assert speeds[-1] == pytest.approx(6.0 / 3.6)
    assert (speeds[1] - speeds[2]) / (times[2] - times[1]) == pytest.approx(DECELERATION_M_S2, rel=1e-3)
    assert motion.at(times[1])[0] == pytest.approx(BEFORE_M)
    assert scenario.road.features == ()


def test_a_smoother_road_stops_the_car_earlier() -> None:
    rough, smooth = (driven_stop(Stop(3, 0, "passive", kind, 0.0), []) for kind in ("E", "A"))
    level = (100.0 / 3.6) ** 2 / (2 * 9.80665)
    for row in (rough, smooth):
        assert row["metrics"]["ideal slip"] <= row["metrics"]["lagging pressure"]
    assert level < smooth["metrics"]["ideal slip"] < 1.05 * level
    assert rough["metrics"]["ideal slip"] > 1.02 * smooth["metrics"]["ideal slip"]
    assert rough["metrics"]["load"] > 3.0 * smooth["metrics"]["load"]


def test_the_table_holds_what_is_saved() -> None:
    def stop(event: int, controller: str, metres: float) -> tuple[Stop, dict[str, float]]:
        found = {"ideal slip": metres, "lagging pressure": metres + 5.0, "load": 0.2}
        return Stop(event, 0, controller, "C", 3.0 * (controller != "passive")), found

    metrics = dict(
        stop(event, name, metres) for event in (0, 1) for name, metres in (("passive", 50.0), ("mpc", 49.0))
    )
    table = stopping_table(metrics)
    assert table[2] == "| passive | 0.200 | 50.0 | 0.00 | 55.0 | 0.00 |"
    assert table[3] == "| mpc, rho = 3 | 0.200 | 49.0 | 1.00 | 54.0 | 1.00 |"
    assert np.char.count(table, "|").tolist() == [7] * 4
