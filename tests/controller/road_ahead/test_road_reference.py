from dataclasses import replace

import numpy as np
import pytest

from foreride.controller.road_ahead.road_reference import RoadReference
from foreride.controller.settings import RoadSettings
from foreride.preview.road_preview import RoadPreview
from foreride.vehicle.load import load_vehicle
from tests.controller.cars import estimate, step_preview

CAR = load_vehicle("quarter")
TIMES = np.linspace(0.0, 0.3, 31)


def ahead(settings: RoadSettings | None = None) -> RoadReference:
    return RoadReference(1, settings or RoadSettings())


def test_without_preview_the_road_stays_where_it_is() -> None:
    road = ahead()
    road.update(estimate(CAR, road=0.03), None)
    np.testing.assert_allclose(road.heights(TIMES), 0.03)


def test_without_preview_a_felt_slope_runs_on_and_fades() -> None:
    road = ahead(RoadSettings(slope_decay_s=0.02))
    road.update(estimate(CAR, road=0.0, road_velocity=1.0), None)
    heights = road.heights(np.array([0.0, 1e-4, 1.0]))[0]
    assert heights[0] == 0.0
    assert heights[1] == pytest.approx(1e-4, rel=0.01)
    assert heights[2] == pytest.approx(0.02)


def test_a_true_preview_is_passed_on_unchanged() -> None:
    road = ahead()
    preview = step_preview(1.0, 0.08)
    road.update(estimate(CAR), preview)
    np.testing.assert_allclose(road.heights(TIMES)[0], preview.height(0, 10.0 * TIMES), atol=1e-12)


def test_what_is_felt_beyond_the_preview_shifts_it() -> None:
    road = ahead()
    road.update(estimate(CAR, road=0.02), step_preview(1.0, 0.08))
    heights = road.heights(TIMES)[0]
    assert heights[0] == pytest.approx(0.02)
    assert heights[-1] == pytest.approx(0.10)


def test_a_foreseen_edge_between_two_looks_is_no_surprise() -> None:
    """10 ms before and at 0.1 m past the edge of a ramp of 8 m/s, fully previewed."""
    road = ahead()
    road.update(estimate(CAR, road=0.0), step_preview(0.05, 0.08))
    later = replace(estimate(CAR, road=0.04, road_velocity=4.0), time_s=0.01)
    preview = step_preview(-0.05, 0.08)
    road.update(later, preview)
    np.testing.assert_allclose(road.heights(TIMES)[0], preview.height(0, 10.0 * TIMES), atol=1e-9)


def test_an_unforeseen_rise_runs_on_and_fades() -> None:
    road = ahead(RoadSettings(slope_decay_s=0.02))
    road.update(estimate(CAR), step_preview(3.0, 0.0))
    road.update(replace(estimate(CAR, road=0.01), time_s=0.01), step_preview(2.9, 0.0))
    assert road.heights(np.array([0.0, 1.0]))[0] == pytest.approx([0.01, 0.01 + 1.0 * 0.02])


def test_in_the_air_the_last_contact_counts_but_the_road_is_never_above_the_tyre() -> None:
    road = ahead()
    road.update(estimate(CAR, road=0.05), None)
    road.update(estimate(CAR, road=0.09, road_velocity=2.0, contact=False), None)
    np.testing.assert_allclose(road.heights(TIMES), 0.05)
    road.update(estimate(CAR, road=0.02, contact=False), None)
    np.testing.assert_allclose(road.heights(TIMES), 0.02)


def test_reset_forgets_what_was_felt() -> None:
    road = ahead()
    road.update(estimate(CAR, road=0.05), None)
    road.reset()
    road.update(estimate(CAR, road=0.09, contact=False), None)
    np.testing.assert_allclose(road.heights(TIMES), 0.0)


def credulous(uncertainty: str, **values: float) -> RoadSettings:
    """Settings that give previews full credibility."""
    return RoadSettings(uncertainty, credibility=1.0, **values)  # type: ignore[arg-type]


def seen(preview: RoadPreview, settings: RoadSettings) -> tuple[np.ndarray, np.ndarray]:
    """Heights of the roads 2.3 m ahead and their weights."""
    road = ahead(settings)
    road.update(estimate(CAR), preview)
    return road.roads(np.array([0.23]))[:, 0, 0], road.weights


def test_doubt_about_existence_lowers_a_feature() -> None:
    for uncertainty in ("early", "blend"):
        heights, weights = seen(step_preview(1.0, 0.08, existence=0.5), credulous(uncertainty))
        assert heights == pytest.approx([0.04])
        assert weights == pytest.approx([1.0])


def test_a_blend_believes_half_of_a_feature_where_it_is_told_to() -> None:
    heights, _ = seen(step_preview(2.0, 0.08, sigma_m=0.3), credulous("blend", blend_m=0.3))
    assert heights == pytest.approx([0.04], rel=0.03)


def test_scenarios_stand_for_the_distribution_of_position_and_existence() -> None:
    """The weights sum to one; the features' positions have the stated mean and variance."""
    settings, distance = credulous("scenarios"), np.linspace(0.0, 5.0, 2001)
    road = ahead(settings)
    road.update(estimate(CAR), step_preview(2.0, 0.08, sigma_m=0.2, existence=0.7))
    heights, weights = road.roads(distance / 10.0)[:, 0], road.weights
    assert weights.sum() == pytest.approx(1.0)
    there = heights.max(axis=1) > 0.04
    assert weights[there].sum() == pytest.approx(0.7)
    edges = np.array([np.interp(0.04, row, distance) for row in heights[there]])
    share = weights[there] / 0.7
    assert share @ edges == pytest.approx(2.05, abs=0.02)
    assert np.sqrt(share @ (edges - share @ edges) ** 2) == pytest.approx(0.2, rel=0.05)


def test_certain_scenarios_are_one_road() -> None:
    heights, weights = seen(step_preview(1.0, 0.08), RoadSettings("scenarios"))
    np.testing.assert_array_equal(np.flatnonzero(weights), [0])
    assert heights[0] == pytest.approx(0.08)


def test_standing_still_the_road_does_not_move() -> None:
    road = ahead()
    road.update(estimate(CAR, road=0.01, speed_m_s=0.0), step_preview(0.05, 0.08))
    np.testing.assert_allclose(road.heights(TIMES), 0.01)


@pytest.mark.parametrize("uncertainty", ["early", "blend", "scenarios"])
@pytest.mark.parametrize("error_m", [-0.1, 0.2])
def test_a_felt_edge_corrects_the_place_of_the_edge_behind_it(error_m: float, uncertainty: str) -> None:
    """A table from 5 to 6 m, previewed `error_m` too far; 0.2 m past its near edge the far one is right."""
    seen_at, distance = 5.2, np.arange(-0.5, 5.0, 0.01)

    def height(x_m: np.ndarray) -> np.ndarray:
        return 0.08 * (np.clip((x_m - 5.0) / 0.1, 0.0, 1.0) - np.clip((x_m - 6.0) / 0.1, 0.0, 1.0))

    row, zeros = np.ones((1, len(distance))), np.zeros((1, len(distance)))
    previewed = height(seen_at + distance - error_m)[None]
    preview = RoadPreview(0.0, distance, previewed, 0.1 * row, zeros, row)
    road = ahead(credulous(uncertainty))
    for time in np.arange(0.0, seen_at / 10.0 + 1e-9, 0.005):
        felt = estimate(CAR, road=float(height(10.0 * time)))
        last = time > seen_at / 10.0 - 0.002
        road.update(replace(felt, time_s=float(time)), preview if last else None)
    behind = distance > 0.3
    fall = road.heights(distance[behind] / 10.0)[0]
    assert np.interp(-0.04, -fall, distance[behind]) == pytest.approx(6.05 - seen_at, abs=0.03)


def test_a_landing_is_no_slope() -> None:
    """What lay between the last bound in the air and the road at touch-down does not run on."""
    road = ahead()
    preview = step_preview(3.0, 0.0)
    road.update(estimate(CAR, road=0.0, contact=False), preview)
    road.update(replace(estimate(CAR, road=0.03), time_s=0.01), preview)
    np.testing.assert_allclose(road.heights(TIMES), 0.03)
