import dataclasses

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from foreride.files.errors import InputError
from foreride.road.features.feature import (
    FEATURES,
    PAINTS,
    ExpansionJoint,
    FlatTopHump,
    HalfSineBump,
    ManholeCover,
    Pothole,
    SinusoidalHump,
    SpeedCushion,
    Step,
    TrapezoidalBump,
    WattsHump,
)

EXAMPLES = [
    HalfSineBump(10.0, 0.08, 0.4),
    WattsHump(10.0),
    FlatTopHump(10.0),
    SinusoidalHump(10.0),
    TrapezoidalBump(10.0),
    SpeedCushion(10.0),
    Pothole(10.0, 0.08, 0.6, 0.5, y_m=0.75, seed=4),
]
potholes = st.builds(
    Pothole,
    start_m=st.floats(0, 100),
    depth_m=st.floats(0.01, 0.2),
    length_m=st.floats(0.2, 2.0),
    width_m=st.floats(0.2, 2.0),
    y_m=st.floats(-3, 3),
    wall_m=st.floats(0.01, 0.1),
    irregularity=st.just(0.0) | st.floats(1e-3, 0.5),
    seed=st.integers(0, 100),
)


def test_half_sine_profile():
    bump = HalfSineBump(10.0, 0.08, 0.4)
    x = 10 + 0.4 * np.array([-0.5, 0, 1 / 6, 0.5, 5 / 6, 1, 1.5])
    np.testing.assert_allclose(bump.height(x, 0), 0.08 * np.array([0, 0, 0.5, 1, 0.5, 0, 0]), atol=1e-12)


def test_watts_profile_is_an_arc_of_the_circle_through_its_ends_and_crest():
    hump = WattsHump(0.0, height_m=0.1, length_m=3.6)
    x = np.linspace(0.1, 3.5, 50)
    radius = (1.8**2 + 0.1**2) / 0.2
    centre_z = 0.1 - radius
    np.testing.assert_allclose(np.hypot(x - 1.8, hump.height(x, 0) - centre_z), radius, rtol=1e-12)
    np.testing.assert_allclose(hump.height([0, 1.8, 3.6], 0), [0, 0.1, 0], atol=1e-12)


def test_flat_top_profile():
    hump = FlatTopHump(5.0, height_m=0.09, length_m=3.6, ramp_m=0.6)
    x = 5 + np.array([-1, 0, 0.3, 0.6, 2.0, 3.0, 3.3, 3.6, 4])
    np.testing.assert_allclose(
        hump.height(x, 0), 0.09 * np.array([0, 0, 0.5, 1, 1, 1, 0.5, 0, 0]), atol=1e-12
    )


def test_sinusoidal_hump_is_a_raised_cosine():
    hump = SinusoidalHump(2.0, 0.1, 4.0)
    x = np.linspace(2, 6, 41)
    np.testing.assert_allclose(hump.height(x, 0), 0.05 * (1 - np.cos(np.pi * (x - 2) / 2)), atol=1e-15)
    assert hump.height(2.001, 0) < 1e-7  # meets the road without an edge


def test_trapezoid_may_rise_steeper_than_it_falls():
    bump = TrapezoidalBump(1.0, 0.06, 0.8, ramp_up_m=0.1, ramp_down_m=0.3)
    x = 1 + np.array([-0.1, 0, 0.05, 0.1, 0.5, 0.65, 0.8, 0.9])
    np.testing.assert_allclose(bump.height(x, 0), 0.06 * np.array([0, 0, 0.5, 1, 1, 0.5, 0, 0]), atol=1e-12)


def test_car_in_the_middle_straddles_a_cushion_and_beside_it_climbs():
    cushion = SpeedCushion(10.0)
    x = np.linspace(10, 13, 301)
    assert not cushion.height(x, 0.75).any()
    assert not cushion.height(x, -0.75).any()
    assert cushion.height(x, 0.75 - 0.5).max() == cushion.height_m
    assert np.abs(np.diff(cushion.height(x, 0))).max() / 0.01 == pytest.approx(0.125)  # 1 in 8
    y = np.linspace(-0.7, 0.7, 281)
    assert np.abs(np.diff(cushion.height(11.5, y))).max() / 0.005 == pytest.approx(0.25)  # 1 in 4


def test_expansion_joint_is_a_gap_between_its_lips():
    plain, lipped = ExpansionJoint(1.0, 0.06, 0.03), ExpansionJoint(1.0, 0.06, 0.03, 0.01, 0.1)
    np.testing.assert_array_equal(plain.height([0.99, 1.03, 1.07], 0.0), [0, -0.03, 0])
    np.testing.assert_array_equal(lipped.height([0.99, 1.05, 1.13, 1.2, 1.27], 0), [0, 0.01, -0.03, 0.01, 0])
    assert (plain.end_m, lipped.end_m) == (pytest.approx(1.06), pytest.approx(1.26))
    assert plain.height(1.03, 3.6) == 0


def test_manhole_cover_is_a_sunk_or_raised_disc():
    sunk = ManholeCover(1.0, -0.03, 0.6, y_m=0.5, edge_m=0.05)
    x, y = np.random.default_rng(0).uniform([0.9, 0.1], [1.7, 0.9], (3000, 2)).T
    inside = np.hypot(x - 1.3, y - 0.5) < 0.3
    np.testing.assert_array_equal(sunk.height(x, y) != 0, inside)
    assert sunk.height(1.3, 0.5) == -0.03
    assert sunk.height(1.025, 0.5) == pytest.approx(-0.015)
    assert ManholeCover(1.0, 0.01).height(1.35, 0.0) == 0.01


def test_step_stays():
    step = Step(5.0, -0.04, ramp_m=0.1, y_min_m=0.0)
    np.testing.assert_allclose(step.height([4, 5, 5.05, 5.1, 500], 1.0), [0, 0, -0.02, -0.04, -0.04])
    assert not step.height([4.0, 6.0], -1.0).any()


def test_bump_runs_out_at_its_lateral_ends():
    bump = HalfSineBump(10.0, 0.08, 0.4, y_min_m=-1.0, y_max_m=2.0, taper_m=0.2)
    y = np.array([-1.1, -1.0, -0.9, -0.8, 1.8, 1.9, 2.0, 2.1])
    expected = 0.08 * np.array([0, 0, 0.5, 1, 1, 0.5, 0, 0])
    np.testing.assert_allclose(bump.height(10.2, y), expected, atol=1e-12)
    sharp = dataclasses.replace(bump, taper_m=0.0)
    np.testing.assert_allclose(sharp.height(10.2, y), 0.08 * np.array([0, 1, 1, 1, 1, 1, 1, 0]), atol=1e-12)


@given(pothole=potholes)
def test_pothole_has_its_length_on_the_centre_line_its_width_and_its_depth(pothole):
    x = np.linspace(pothole.start_m - 0.5, pothole.end_m + 0.5, 241)[:, None]
    y = np.linspace(pothole.y_min_m - 0.5, pothole.y_max_m + 0.5, 241)
    hole, step = pothole.footprint(x, y), max(x[1, 0] - x[0, 0], y[1] - y[0])
    centre = pothole.footprint(x[:, 0], pothole.y_m)
    assert np.count_nonzero(centre) * (x[1, 0] - x[0, 0]) == pytest.approx(pothole.length_m, abs=2 * step)
    assert y[hole.any(axis=0)].min() >= pothole.y_min_m - 1e-9
    assert y[hole.any(axis=0)].max() <= pothole.y_max_m + 1e-9
    assert np.ptp(y[hole.any(axis=0)]) == pytest.approx(pothole.width_m, abs=0.05)
    assert x[hole.any(axis=1)].min() >= pothole.start_m - 1e-9
    assert x[hole.any(axis=1)].max() <= pothole.end_m + 1e-9
    middle = pothole.start_m + pothole.length_m / 2
    assert pothole.height(middle, pothole.y_m) == pytest.approx(-pothole.depth_m)


def test_regular_pothole_is_an_ellipse_with_sloped_walls_and_flat_floor():
    hole = Pothole(0.0, 0.08, 0.6, 0.4, wall_m=0.1, irregularity=0.0)
    x = np.array([0, 0.05, 0.1, 0.3, 0.5, 0.55, 0.6])
    np.testing.assert_allclose(hole.height(x, 0), -0.08 * np.array([0, 0.5, 1, 1, 1, 0.5, 0]), atol=1e-9)
    xs, ys = np.random.default_rng(0).uniform([-0.1, -0.3], [0.7, 0.3], (2000, 2)).T
    inside = ((xs - 0.3) / 0.3) ** 2 + (ys / 0.2) ** 2 < 1
    np.testing.assert_array_equal(hole.footprint(xs, ys), inside)


def test_rim_depends_on_the_seed_alone():
    x, y = np.linspace(0, 0.6, 80)[:, None], np.linspace(-0.3, 0.3, 80)
    shapes = [Pothole(0.0, 0.08, 0.6, 0.6, seed=s).footprint(x, y) for s in (1, 1, 2)]
    np.testing.assert_array_equal(shapes[0], shapes[1])
    assert np.any(shapes[0] != shapes[2])


@pytest.mark.parametrize("feature", EXAMPLES, ids=lambda f: f.kind)
def test_height_is_zero_outside_the_footprint_continuous_and_of_one_sign(feature):
    x = np.linspace(feature.start_m - 0.2, feature.end_m + 0.2, 1500)[:, None]
    y = np.linspace(feature.y_min_m - 0.2, feature.y_max_m + 0.2, 301)
    z = feature.height(x, y)
    assert z.shape == feature.footprint(x, y).shape == (1500, 301)
    assert np.all(z[~feature.footprint(x, y)] == 0)
    assert np.all(z >= -1e-12) if feature.cls == 0 else np.all(z <= 0)
    assert np.abs(np.diff(z, axis=0)).max() < 0.01


def test_kinds_and_paints():
    assert set(FEATURES.own) == {
        "half_sine_bump", "sinusoidal_hump", "watts_hump", "flat_top_hump", "trapezoidal_bump",
        "speed_cushion", "pothole", "expansion_joint", "manhole_cover", "step",
    }  # fmt: skip
    assert [f.cls for f in EXAMPLES] == [0, 0, 0, 0, 0, 0, 1]
    assert {kind.cls for kind in (ExpansionJoint, ManholeCover, Step)} == {None}
    for paint in PAINTS:
        assert HalfSineBump(1.0, 0.05, 0.4, paint=paint).paint == paint


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: HalfSineBump(1.0, -0.1, 0.4), r"^height_m must lie in 0\.0001 \.\.\. 0\.5 m, got -0\.1$"),
        (lambda: HalfSineBump(float("nan"), 0.1, 0.4), "^start_m must lie in .*, got nan$"),
        (lambda: HalfSineBump(1.0, 0.1, 0.0), "^length_m must lie in 0.001"),
        (lambda: HalfSineBump(1.0, "0.1", 0.4), "^height_m must be a number.*'0.1'"),
        (lambda: HalfSineBump(1.0, 0.1, 0.4, y_min_m=1.0, y_max_m=1.0), "^y_max_m must be > 1"),
        (lambda: HalfSineBump(1.0, 0.1, 0.4, taper_m=4.0), "^taper_m must be >= 0 and <= 3.5"),
        (lambda: HalfSineBump(1.0, 0.1, 0.4, paint="blue"), "^paint must be one of plain, .*'blue'"),
        (lambda: TrapezoidalBump(1.0, ramp_up_m=0.5), "^ramp_down_m must be > 0 and <= 0.1, got 0.2"),
        (lambda: SpeedCushion(1.0, taper_m=0.8), "^taper_m must be >= 0 and <= 0.7"),
        (lambda: ExpansionJoint(1.0, gap_m=0.0), "^gap_m must lie in 0.001"),
        (lambda: ManholeCover(1.0, edge_m=0.5), "^edge_m must be > 0 and <= 0.35"),
        (lambda: Step(1.0, 0.0), "^height_m must differ from 0"),
        (lambda: WattsHump(1.0, height_m=0.3, length_m=0.4), "^height_m must be <= length_m / 2"),
        (lambda: FlatTopHump(1.0, ramp_m=2.0), "^ramp_m must be > 0 and <= 1.8"),
        (lambda: Pothole(1.0, 0.0, 0.6, 0.5), "^depth_m must lie in 0.0001"),
        (lambda: Pothole(1.0, 0.1, 0.6, 0.5, wall_m=0.3), "^wall_m must be > 0 and <= 0.25"),
        (lambda: Pothole(1.0, 0.1, 0.6, 0.5, irregularity=0.9), "^irregularity must lie"),
        (lambda: Pothole(1.0, 0.1, 0.6, 0.5, seed=1.5), "^seed must be a whole number, .*, got 1.5"),
        (lambda: Pothole(1.0, True, 0.6, 0.5), "^depth_m must be a number"),
    ],
)
def test_bad_input_names_the_field(make, message):
    with pytest.raises(InputError, match=message):
        make()
