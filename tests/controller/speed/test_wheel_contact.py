"""Road that a wheel can follow: against the fall of a free wheel, integrated step by step."""

import numpy as np
import pytest

from foreride.controller.speed.wheel_contact import followed
from tests.vehicle.plant.short_drives import HALF

PIECE_M = 0.05
CORNER = HALF.corners[0]
SLACK_M = CORNER.static_tyre_n / CORNER.tyre_n_m
AT_M = PIECE_M * np.arange(80)
HOLE = np.where((AT_M > 1.0) & (AT_M < 2.0), -0.3, 0.0)


@pytest.mark.parametrize("damping_ns_m", [0.0, 1500.0])
def test_behind_an_edge_it_falls_as_a_free_wheel_does(damping_ns_m: float) -> None:
    speed = 12.0
    heights = followed(HOLE, PIECE_M, np.array([speed]), CORNER, damping_ns_m)[0]
    fallen, rate, step_s = 0.0, 0.0, 1e-5
    for _ in range(round(0.3 / speed / step_s)):
        rate += step_s * (CORNER.static_tyre_n - damping_ns_m * rate) / CORNER.unsprung_mass_kg
        fallen += step_s * rate
    assert heights[round(1.3 / PIECE_M)] == pytest.approx(-SLACK_M - fallen, abs=1e-3)


def test_the_faster_the_less_of_a_hole_is_left() -> None:
    lowest = followed(HOLE, PIECE_M, np.array([2.0, 15.0, 40.0, 80.0]), CORNER, 1500.0).min(axis=1)
    assert lowest[0] == HOLE.min()
    assert (np.diff(lowest) > 0.01).all()


def test_a_road_within_the_tyres_deflection_is_followed_exactly() -> None:
    rough = 0.9 * SLACK_M * np.random.default_rng(0).uniform(size=80)
    np.testing.assert_array_equal(followed(rough, PIECE_M, np.array([30.0]), CORNER, 1500.0)[0], rough)


def test_it_never_lies_below_the_road_and_rises_at_once() -> None:
    bump = -HOLE
    heights = followed(bump, PIECE_M, np.array([5.0, 20.0]), CORNER, 1500.0)
    assert (heights >= bump).all()
    np.testing.assert_array_equal(heights[:, AT_M < 2.0], np.tile(bump[AT_M < 2.0], (2, 1)))
