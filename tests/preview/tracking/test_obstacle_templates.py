import numpy as np
import pytest

from foreride.preview.obstacle_classes import (
    BLOCK,
    BUMP,
    CUSHION,
    HUMP,
    KINDS,
    LONG_TABLE,
    POTHOLE,
    SINUSOIDAL,
    TABLE,
    TEMPLATE_OF_FEATURE,
    templates_of,
)
from foreride.preview.tracking.obstacle_templates import chord, tyre_profile, unit_profile
from foreride.road.features.bumps import _RaisedFeature
from foreride.road.features.feature import (
    FlatTopHump,
    HalfSineBump,
    Pothole,
    SinusoidalHump,
    SpeedCushion,
    TrapezoidalBump,
    WattsHump,
)
from foreride.road.road import Road
from foreride.road.tyre.tyre import Tyre
from foreride.road.tyre.wheel_profile import wheel_profile


@pytest.mark.parametrize("kind", KINDS)
def test_relief_is_zero_at_both_ends_and_one_at_most(kind):
    values = kind.sign * unit_profile(kind, np.linspace(0.0, 1.0, 201), kind.length_m)
    assert values[[0, -1]] == pytest.approx(0.0, abs=1e-12)
    assert values.max() == pytest.approx(1.0, abs=1e-3)
    assert values.min() >= -1e-12


@pytest.mark.parametrize(
    ("feature", "kind", "tolerance"),
    [
        (HalfSineBump(10.0, 0.08, 0.40), BUMP, 0.001),
        (Pothole(10.0, 0.08, 0.60, 0.6, y_m=0.75, wall_m=0.06), POTHOLE, 0.002),
        (WattsHump(10.0), HUMP, 0.001),
        (FlatTopHump(10.0, ramp_m=0.9), TABLE, 0.001),
        (FlatTopHump(10.0, length_m=6.6, ramp_m=0.9), LONG_TABLE, 0.001),
        (SinusoidalHump(10.0), SINUSOIDAL, 0.001),
        (TrapezoidalBump(10.0), BLOCK, 0.001),
        (SpeedCushion(10.0, ramp_m=0.55, y_min_m=0.0, y_max_m=1.5), CUSHION, 0.002),
    ],
)
def test_tyre_profile_is_what_the_road_package_makes_of_the_true_feature(feature, kind, tolerance):
    truth = wheel_profile(Road(30.0, (feature,)), 0.75)
    height = feature.depth_m if kind is POTHOLE else feature.height_m
    x, felt = tyre_profile(kind, feature.length_m, height)
    np.testing.assert_allclose(felt, truth.height(x + 10.0), atol=tolerance)
    assert felt[[0, -1]] == pytest.approx(0.0, abs=1e-9)


def test_the_tyre_meets_a_bump_before_its_edge_and_a_hole_after():
    x, bump = tyre_profile(BUMP, 0.4, 0.08)
    assert x[np.argmax(bump > 0.005)] < 0.0
    x, hole = tyre_profile(POTHOLE, 0.6, 0.08)
    assert x[np.argmax(hole < -0.005)] > 0.0


def test_a_detector_class_names_its_kinds():
    assert templates_of(0) == tuple(kind for kind in KINDS if kind is not POTHOLE)
    assert templates_of(1) == (POTHOLE,)


@pytest.mark.parametrize("cls", [0, 1])
def test_the_shares_of_a_class_sum_to_one(cls: int) -> None:
    assert sum(kind.share for kind in templates_of(cls)) == pytest.approx(1.0)


def test_every_kind_of_feature_that_is_seen_has_a_template_of_its_class() -> None:
    for feature in (*_RaisedFeature.__subclasses__(), Pothole):
        assert TEMPLATE_OF_FEATURE[feature.kind].cls == feature.cls


def test_chord_of_an_ellipse():
    assert chord(0.8, 0.6, 0.0) == pytest.approx(0.8)
    assert chord(0.8, 0.6, 0.18) == pytest.approx(0.8 * 0.8)  # 3-4-5 triangle
    assert chord(0.8, 0.6, 0.4) == 0.0


@pytest.mark.parametrize(
    ("kind", "lengths", "heights"),
    [
        (BUMP, (0.35, 0.39), (0.05, 0.09)),  # Indonesia, PM 14/2021
        (HUMP, (3.7,), (0.075, 0.10)),  # UK, round-top
        (HUMP, (3.7,), (0.08, 0.10)),  # Brazil, type A
        (HUMP, (12 * 0.3048,), (3 * 0.0254, 4 * 0.0254)),  # USA, 12 feet
        (SINUSOIDAL, (3.7,), (0.075, 0.10)),  # TRL 377
        (TABLE, (12 * 0.3048,), (0.075, 0.10)),  # UK, USA
        (LONG_TABLE, (22 * 0.3048, 6.6 + 1.2), (3 * 0.0254, 0.09)),  # USA, Indonesia
        (CUSHION, (1.7, 3.7), (0.06, 0.08)),  # UK, LTN 1/07
    ],
)
def test_priors_cover_what_road_design_rules_allow(kind, lengths, heights):
    """Within two standard deviations."""
    for length in lengths:
        assert abs(length - kind.length_m) < 2 * kind.length_sigma_m
    for height in heights:
        assert abs(height - kind.height_m) < 2 * kind.height_sigma_m


def test_kept_profiles_cannot_be_changed_by_those_who_get_them():
    for values in tyre_profile(BUMP, 0.4, 0.08):
        with pytest.raises(ValueError, match="read-only"):
            values[0] = 1.0


def test_a_profile_has_a_point_each_centimetre_from_half_a_metre_before_to_half_a_metre_behind():
    """Lengths are rounded to 1 cm, heights to 2 mm; a large wheel reaches 1.6 times its radius."""
    x, height = tyre_profile(BUMP, 0.404, 0.0809)
    np.testing.assert_allclose(x, -0.5 + 0.01 * np.arange(141), atol=1e-12)
    np.testing.assert_array_equal(height, tyre_profile(BUMP, 0.4, 0.08)[1])
    assert tyre_profile(BUMP, 0.4, 0.0812)[1].max() > height.max()
    large = Tyre(radius_m=0.5)
    assert tyre_profile(BUMP, 0.4, 0.08, large)[0][[0, -1]] == pytest.approx([-0.8, 1.2])
