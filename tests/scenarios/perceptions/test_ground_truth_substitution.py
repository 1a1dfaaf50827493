"""Tests of ground-truth substitution: substituted values are exact, the others unchanged."""

import numpy as np
import pytest

from foreride.preview.settings import Settings
from foreride.preview.tracking.mounting_filter import Calibration
from foreride.preview.tracking.track import Edge, Track, first_fits
from foreride.road.features.feature import HalfSineBump, Pothole, WattsHump
from foreride.scenarios.perceptions.ground_truth_substitution import track_corrector

FEATURES = (HalfSineBump(30.0, 0.08, 0.5), WattsHump(60.0, 0.09, 3.6), Pothole(31.0, 0.06, 0.7, 0.6))


def track(cls: int, x_m: float) -> Track:
    fits = first_fits(cls, x_m, 0.1, Calibration(Settings(), 457.0).prior(cls))
    return Track(1, cls, 0.0, 2.0, Edge(-1.0, 0.01), Edge(0.5, 0.01), fits)


def test_nothing_told_is_no_corrector() -> None:
    assert track_corrector(FEATURES, ()) is None


def test_distance_is_that_of_the_feature_in_the_odometers_reckoning() -> None:
    correct = track_corrector(FEATURES, ("distance",))
    assert correct is not None
    wrong = track(0, 60.4)
    found = correct(wrong, 0.15)
    assert found.start_m == pytest.approx(60.15)
    assert found.best.kind is wrong.best.kind
    np.testing.assert_array_equal(found.best.state[1:], wrong.best.state[1:])
    assert wrong.start_m == 60.4


@pytest.mark.parametrize(
    ("cls", "x_m", "kind", "length", "height"),
    [(0, 30.2, "bump", 0.5, 0.08), (0, 59.7, "hump", 3.6, 0.09), (1, 31.3, "pothole", 0.7, 0.06)],
)
def test_shape_is_that_of_the_feature_where_the_track_believes_it(
    cls: int, x_m: float, kind: str, length: float, height: float
) -> None:
    correct = track_corrector(FEATURES, ("shape",))
    assert correct is not None
    found = correct(track(cls, x_m), 0.0)
    assert (found.best.kind.name, found.start_m) == (kind, x_m)
    section = found.section(found.centre_y_m)
    assert section.length_m == pytest.approx(length)
    assert section.height_m == pytest.approx(height)


def test_what_is_nowhere_near_stays() -> None:
    correct = track_corrector(FEATURES, ("distance", "shape"))
    assert correct is not None
    ghost = track(1, 60.0)
    assert correct(ghost, 0.0) is ghost
