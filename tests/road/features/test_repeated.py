import numpy as np
import pytest

from foreride.files.errors import InputError
from foreride.road.features.feature import (
    ExpansionJoint,
    FlatTopHump,
    HalfSineBump,
    ManholeCover,
    Pothole,
    SpeedCushion,
)
from foreride.road.features.repeated import Chain
from foreride.road.road import Road


def test_copies_stand_at_equal_distances():
    joints = Chain(ExpansionJoint(10.0), count=5, spacing_m=4.0).features()
    assert [joint.start_m for joint in joints] == [10, 14, 18, 22, 26]
    assert {joint.y_min_m for joint in joints} == {-3.5}


def test_potholes_alternate_between_the_tracks_with_a_rim_each():
    holes = Chain(Pothole(10.0, 0.05, 0.5, 0.5, seed=7), 4, 2.0, ("left", "right")).features()
    assert [hole.y_m for hole in holes] == [0.75, -0.75, 0.75, -0.75]
    assert [hole.seed for hole in holes] == [7, 8, 9, 10]


@pytest.mark.parametrize("feature", [Pothole(10.0, 0.05, 0.5, 0.5), ManholeCover(10.0), SpeedCushion(10.0)])
def test_both_makes_two_of_what_is_narrow(feature):
    left, right = Chain(feature, tracks=("both",), track_m=1.6).features()
    assert (left.y_min_m + left.y_max_m) / 2 == pytest.approx(0.8)
    assert (right.y_min_m + right.y_max_m) / 2 == pytest.approx(-0.8)
    assert left.y_max_m - left.y_min_m == pytest.approx(feature.y_max_m - feature.y_min_m)


def test_one_track_of_a_bump_is_half_of_it():
    road = Road(40.0, chains=(Chain(HalfSineBump(10.0, 0.05, 0.4), 3, 5.0, ("left", "right", "both")),))
    crests = 10.2 + 5.0 * np.arange(3)
    np.testing.assert_allclose(road.height(crests, 0.75), [0.05, 0, 0.05], atol=1e-12)
    np.testing.assert_allclose(road.height(crests, -0.75), [0, 0.05, 0.05], atol=1e-12)


def test_chains_and_features_combine_in_order_of_place():
    hole = Pothole(11.5, 0.04, 0.5, 0.5, y_m=0.75, irregularity=0.0)
    road = Road(40.0, (FlatTopHump(10.0), hole), chains=(Chain(ExpansionJoint(5.0), 2, 20.0),))
    assert [f.start_m for f in road.features] == [5.0, 10.0, 11.5, 25.0]
    assert road.chains == ()
    assert road.height(11.75, 0.75) == pytest.approx(0.09 - 0.04)  # a hole in the table's top


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Chain(ExpansionJoint(1.0), 0), "^count must lie in 1 .*, got 0"),
        (lambda: Chain(ExpansionJoint(1.0), 3), "^spacing_m must be > 0 for count = 3"),
        (
            lambda: Chain(HalfSineBump(1.0, 0.1, 0.4, y_min_m=1.0), tracks=("left",)).features(),
            "^tracks: left",
        ),
        (
            lambda: Road(9.0, chains=(Chain(ExpansionJoint(1.0), 3, 4.0),)),
            r"^chains \(expansion_joint\) spans 9",
        ),
    ],
)
def test_bad_input_names_the_field(make, message):
    with pytest.raises(InputError, match=message):
        make()
