"""Grade-change detector: spans of 50 ms, against the usual rise of the road."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from foreride.preview.ego_motion.grade_change_detector import GradeChangeDetector
from foreride.preview.settings import Settings

STEP, SPAN = 0.005, 10  # readings a span
SETTINGS = Settings()


def told(heights, roughness_m=0.003):
    """Result after each reading."""
    watch = GradeChangeDetector(SETTINGS)
    return [watch.add(np.asarray(height), STEP, roughness_m) for height in heights]


@given(st.lists(st.floats(-0.019, 0.019), min_size=40, max_size=80))
def test_roughness_asks_for_nothing(heights):
    assert all(answer is None for answer in told([[h, -h] for h in heights]))


def test_the_mean_over_a_span_is_asked_for():
    heights = np.stack([np.linspace(0.02, 0.04, SPAN), np.zeros(SPAN)], axis=1)
    answers = told(heights)
    assert all(answer is None for answer in answers[:-1])
    assert answers[-1] == pytest.approx([0.03, 0.0])


def test_a_rough_road_rises_higher_before_its_grade_has_changed():
    heights = [[0.05, 0.0]] * SPAN
    assert told(heights, roughness_m=0.05 / SETTINGS.grade_rises * 0.99)[-1] is not None
    assert told(heights, roughness_m=0.05 / SETTINGS.grade_rises * 1.01)[-1] is None


def test_what_the_change_itself_adds_to_the_roughness_does_not_hide_it():
    watch = GradeChangeDetector(SETTINGS)
    answers = [watch.add(np.zeros(2), STEP, 0.003) for _ in range(5 * SPAN)]
    answers += [watch.add(np.full(2, 0.03), STEP, 0.02) for _ in range(SPAN)]
    assert answers[-1] is not None
    assert watch.roughness_m == 0.003


def test_the_plane_settles_for_a_second():
    watch = GradeChangeDetector(SETTINGS)
    heights = [[0.03, 0.03]] * SPAN + [[0.0, 0.0]] * (30 * SPAN)
    asked, unsettled = [], []
    for height in heights:
        asked.append(watch.add(np.asarray(height), STEP, 0.003) is not None)
        unsettled.append(watch.unsettled)
    assert sum(asked) == pytest.approx(1.0 / (SPAN * STEP), abs=1)
    assert unsettled[SPAN - 1] == 1.0
    assert np.all(np.diff(unsettled[SPAN:]) <= 0.0)
    assert unsettled[-1] == 0.0


@pytest.mark.parametrize(("spans", "found"), [(5, True), (6, False)])
def test_the_least_roughness_of_the_last_six_spans_counts(spans, found):
    """A road that has become rough was smooth in the first of six spans of 50 ms, or rough in all of them."""
    watch = GradeChangeDetector(SETTINGS)
    for _ in range(8 * SPAN):
        watch.add(np.zeros(2), STEP, 0.003)
    for _ in range((spans - 1) * SPAN):
        watch.add(np.zeros(2), STEP, 0.02)
    answers = [watch.add(np.full(2, 0.05), STEP, 0.02) for _ in range(SPAN)]
    assert (answers[-1] is not None) == found


def test_the_first_span_is_a_mean_of_its_own_readings_for_each_axle():
    """Before it nothing is unsettled; after a change the plane settles by the square of what is left."""
    watch = GradeChangeDetector(SETTINGS)
    assert watch.unsettled == 0.0
    for axles in ([0.05], [0.06]):
        answers = [watch.add(np.array(axles), STEP, 0.003) for _ in range(SPAN)]
        assert answers[:-1] == [None] * (SPAN - 1)
        np.testing.assert_allclose(answers[-1], axles, atol=1e-12)
    assert watch.unsettled == 1.0
    for _ in range(SPAN):
        watch.add(np.zeros(1), STEP, 0.003)
    assert watch.unsettled == pytest.approx((19.0 / 20.0) ** 2)
