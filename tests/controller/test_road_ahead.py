from dataclasses import replace

import numpy as np
import pytest

from controller.road_ahead import RoadAhead, expected_heights
from controller.settings import RoadSettings
from tests.controller.cars import estimate, step_preview
from vehicle.parameters import load_vehicle

CAR = load_vehicle("quarter")
TIMES = np.linspace(0.0, 0.3, 31)


def ahead(settings: RoadSettings | None = None) -> RoadAhead:
    return RoadAhead(1, settings or RoadSettings())


def test_without_preview_the_road_stays_where_it_is() -> None:
    road = ahead()
    road.look(estimate(CAR, road=0.03), None)
    np.testing.assert_allclose(road.heights(TIMES), 0.03)


def test_without_preview_a_felt_slope_runs_on_and_fades() -> None:
    road = ahead(RoadSettings(slope_decay_s=0.02))
    road.look(estimate(CAR, road=0.0, road_velocity=1.0), None)
    heights = road.heights(np.array([0.0, 1e-4, 1.0]))[0]
    assert heights[0] == 0.0
    assert heights[1] == pytest.approx(1e-4, rel=0.01)
    assert heights[2] == pytest.approx(0.02)


def test_a_true_preview_is_passed_on_unchanged() -> None:
    road = ahead()
    preview = step_preview(1.0, 0.08)
    road.look(estimate(CAR), preview)
    np.testing.assert_allclose(road.heights(TIMES)[0], preview.height(0, 10.0 * TIMES), atol=1e-12)


def test_what_is_felt_beyond_the_preview_shifts_it() -> None:
    road = ahead()
    road.look(estimate(CAR, road=0.02), step_preview(1.0, 0.08))
    heights = road.heights(TIMES)[0]
    assert heights[0] == pytest.approx(0.02)
    assert heights[-1] == pytest.approx(0.10)


def test_a_foreseen_edge_between_two_looks_is_no_surprise() -> None:
    """10 ms before and at 0.1 m past the edge of a ramp of 8 m/s: all of it was in the preview."""
    road = ahead()
    road.look(estimate(CAR, road=0.0), step_preview(0.05, 0.08))
    later = replace(estimate(CAR, road=0.04, road_velocity=4.0), time_s=0.01)
    preview = step_preview(-0.05, 0.08)
    road.look(later, preview)
    np.testing.assert_allclose(road.heights(TIMES)[0], preview.height(0, 10.0 * TIMES), atol=1e-9)


def test_an_unforeseen_rise_runs_on_and_fades() -> None:
    road = ahead(RoadSettings(slope_decay_s=0.02))
    road.look(estimate(CAR), step_preview(3.0, 0.0))
    road.look(replace(estimate(CAR, road=0.01), time_s=0.01), step_preview(2.9, 0.0))
    assert road.heights(np.array([0.0, 1.0]))[0] == pytest.approx([0.01, 0.01 + 1.0 * 0.02])


def test_in_the_air_the_last_contact_counts_but_the_road_is_never_above_the_tyre() -> None:
    road = ahead()
    road.look(estimate(CAR, road=0.05), None)
    road.look(estimate(CAR, road=0.09, road_velocity=2.0, contact=False), None)
    np.testing.assert_allclose(road.heights(TIMES), 0.05)
    road.look(estimate(CAR, road=0.02, contact=False), None)
    np.testing.assert_allclose(road.heights(TIMES), 0.02)


def test_reset_forgets_what_was_felt() -> None:
    road = ahead()
    road.look(estimate(CAR, road=0.05), None)
    road.reset()
    road.look(estimate(CAR, road=0.09, contact=False), None)
    np.testing.assert_allclose(road.heights(TIMES), 0.0)


def test_doubt_about_position_makes_a_feature_come_earlier_by_its_sigma() -> None:
    preview = step_preview(2.0, 0.08, sigma_m=0.25)
    early = expected_heights(preview, 0, 1.0)
    grid = preview.distance_m
    assert np.interp(1.9, grid, early) == pytest.approx(0.08)
    assert np.interp(1.7, grid, early) == pytest.approx(0.0, abs=1e-9)
    np.testing.assert_array_equal(expected_heights(preview, 0, 0.0), preview.height_m[0])


def test_doubt_about_existence_lowers_a_feature() -> None:
    assert expected_heights(step_preview(1.0, 0.08, existence=0.5), 0, 1.0).max() == pytest.approx(0.04)


def test_standing_still_the_road_does_not_move() -> None:
    road = ahead()
    road.look(estimate(CAR, road=0.01, speed_m_s=0.0), step_preview(0.05, 0.08))
    np.testing.assert_allclose(road.heights(TIMES), 0.01)
