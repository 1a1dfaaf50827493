from dataclasses import replace

import numpy as np
import pytest

from foreride.preview.obstacle_classes import BUMP, HUMP, LONG_TABLE, POTHOLE, TABLE, templates_of
from foreride.preview.settings import Settings
from foreride.preview.tracking.box_equations import box_equations, profile_points, silhouette
from foreride.preview.tracking.gauss_newton import (
    DirectMeasurement,
    EdgeBearings,
    fit,
    fits,
)
from foreride.preview.tracking.mounting_filter import Gaussian
from foreride.preview.tracking.object_state import EDGE_BIAS, GROUND, HEIGHT, LENGTH, OFFSET, X
from foreride.preview.tracking.obstacle_templates import unit_profile

SETTINGS = Settings()
SIGMA = 1.0 / 457.0
GROUND_SIGMA = 0.015
LOW_SIGMA = 0.3 / 457.0
PRIOR = Gaussian(np.zeros(3), np.diag([np.deg2rad(0.25), GROUND_SIGMA, LOW_SIGMA]) ** 2)
FROZEN = Gaussian(np.zeros(3), np.diag([1e-6, GROUND_SIGMA, 1e-6]) ** 2)


def bearings_of(kind, state, camera_x, noise=0.0, rng=None):
    """Exact edge bearings of an object in `state`, from a camera 1.3 m high."""
    camera_z = np.full(len(camera_x), 1.3)
    ahead, below, _ = silhouette(kind, state, camera_x, camera_z)
    bottom = np.arctan2(camera_z - state[GROUND], state[X] - camera_x) - state[OFFSET] + state[EDGE_BIAS]
    top = np.arctan2(below, ahead) - state[OFFSET]
    if rng is not None:
        bottom, top = bottom + noise * rng.normal(size=len(top)), top + noise * rng.normal(size=len(top))
    return [
        EdgeBearings(0.0, x, 1.3, float(b), float(t), SIGMA, SIGMA)
        for x, b, t in zip(camera_x, bottom, top, strict=True)
    ]


def equations_at(kind, data, state, settings):
    """Information, gradient and cost of the boxes."""
    sums = np.empty((1, 6, 6)), np.empty((1, 6)), np.empty(1)
    profiles = profile_points(kind, state[LENGTH])[None]
    box_equations(data, profiles, state[None], settings.correlation, *sums)
    return [one[0] for one in sums]


def start_of(kind, x):
    return np.array([x, 0.0, 0.0, kind.length_m, kind.height_m, 0.0])


@pytest.mark.parametrize("kind", [BUMP, HUMP, POTHOLE])
def test_exact_boxes_give_the_edge_and_the_pitch_offset(kind):
    true = np.array([30.0, np.deg2rad(0.2), 0.0, kind.length_m, kind.height_m, 0.0])
    found = fit(
        kind,
        bearings_of(kind, true, np.linspace(5.0, 26.0, 40)),
        start_of(kind, 30.5),
        PRIOR,
        [],
        SETTINGS,
        iterations=8,
    )
    assert found.state[X] == pytest.approx(30.0, abs=0.02)
    assert np.rad2deg(found.state[OFFSET]) == pytest.approx(0.2, abs=0.03)


@pytest.mark.parametrize(
    ("kind", "length", "height"),
    [(HUMP, 1.5, 0.07), (LONG_TABLE, 5.2, 0.08), (TABLE, 2.4, 0.07)],
    ids=["Brazil, type B", "table between the templates", "short table"],
)
def test_boxes_overrule_the_prior_length_of_objects_that_rules_make_otherwise(kind, length, height):
    true = np.array([30.0, 0.0, 0.0, length, height, 0.0])
    bearings = bearings_of(kind, true, np.linspace(5.0, 26.0, 40))
    fits = [fit(k, bearings, start_of(k, 30.3), PRIOR, [], SETTINGS, iterations=12) for k in templates_of(0)]
    best = min(fits, key=lambda found: found.cost)
    assert best.state[LENGTH] == pytest.approx(length, rel=0.15)
    assert best.state[X] == pytest.approx(30.0, abs=0.05)


def test_without_the_offset_state_the_edge_is_wrong():
    """0.2 degrees at 4 m are 4-5 cm: the error that the offset state removes."""
    true = np.array([30.0, np.deg2rad(0.2), 0.0, BUMP.length_m, BUMP.height_m, 0.0])
    bearings = bearings_of(BUMP, true, np.linspace(5.0, 26.0, 40))
    frozen = fit(BUMP, bearings, start_of(BUMP, 30.0), FROZEN, [], SETTINGS, iterations=8)
    free = fit(BUMP, bearings, start_of(BUMP, 30.0), PRIOR, [], SETTINGS, iterations=8)
    assert abs(frozen.state[X] - 30.0) > 4 * abs(free.state[X] - 30.0)


@pytest.mark.parametrize("kind", [BUMP, HUMP, POTHOLE])
def test_gradient_agrees_with_differences_of_the_cost(kind):
    """The Cauchy cost's gradient, by central differences, is minus the weighted gradient of the step."""
    settings = Settings(correlation=1.0)
    true = np.array([30.0, 0.002, 0.005, kind.length_m * 1.1, kind.height_m, 0.001])
    data = np.array(bearings_of(kind, true, np.linspace(10.0, 26.0, 9)))
    state = start_of(kind, 30.04)
    _, gradient, _ = equations_at(kind, data, state, settings)
    for entry in (X, OFFSET, GROUND, LENGTH, HEIGHT, EDGE_BIAS):
        step = np.zeros(6)
        step[entry] = 1e-6
        rise = equations_at(kind, data, state + step, settings)[2]
        fall = equations_at(kind, data, state - step, settings)[2]
        assert gradient[entry] == pytest.approx(-(rise - fall) / 2e-6, rel=2e-3, abs=0.3)


def test_kinds_that_are_fitted_together_do_not_touch_each_other():
    """With a cut edge, a measured position and different starts."""
    bearings = bearings_of(HUMP, start_of(HUMP, 30.0), np.linspace(8.0, 25.0, 12))
    bearings[4] = bearings[4]._replace(bottom=np.nan)
    struck = [DirectMeasurement(X, 30.1, 0.03)]
    starts = {kind: start_of(kind, 30.0 + 0.1 * k) for k, kind in enumerate(templates_of(0))}
    together = fits(starts, bearings, PRIOR, struck, SETTINGS, 4)
    assert [one.kind for one in together] == list(starts)
    for one in together:
        alone = fit(one.kind, bearings, starts[one.kind], PRIOR, struck, SETTINGS, 4)
        np.testing.assert_array_equal(one.state, alone.state)
        np.testing.assert_array_equal(one.covariance, alone.covariance)
        assert one.cost == pytest.approx(alone.cost, rel=1e-12)


def test_one_wrong_box_hardly_matters():
    true = start_of(BUMP, 30.0)
    bearings = bearings_of(BUMP, true, np.linspace(8.0, 25.0, 30))
    wrong = bearings[20]._replace(bottom=bearings[20].bottom + 40 * SIGMA, top=bearings[20].top + 40 * SIGMA)
    clean = fit(BUMP, bearings, true, PRIOR, [], SETTINGS)
    dirty = fit(BUMP, [*bearings[:20], wrong, *bearings[21:]], true, PRIOR, [], SETTINGS)
    assert dirty.state[X] == pytest.approx(clean.state[X], abs=0.01)


def test_boxes_tell_a_bump_from_a_hump():
    camera_x = np.linspace(8.0, 25.0, 30)
    for true_kind, other in ((BUMP, HUMP), (HUMP, BUMP)):
        bearings = bearings_of(true_kind, start_of(true_kind, 30.0), camera_x)
        own = fit(true_kind, bearings, start_of(true_kind, 30.0), PRIOR, [], SETTINGS, 6)
        alien = fit(other, bearings, start_of(other, 30.0), PRIOR, [], SETTINGS, 6)
        assert own.cost < alien.cost


def test_claimed_sigma_covers_the_scatter_and_is_not_vain():
    """White noise of one pixel, inflated by `correlation`: NEES of X lies between that and 1."""
    rng = np.random.default_rng(11)
    nees = []
    for _ in range(60):
        true = start_of(BUMP, 30.0)
        true[OFFSET] = np.deg2rad(0.25) * rng.normal()
        true[LENGTH] += BUMP.length_sigma_m * rng.normal()
        true[HEIGHT] += BUMP.height_sigma_m * rng.normal()
        true[GROUND] = GROUND_SIGMA * rng.normal()
        true[EDGE_BIAS] = LOW_SIGMA * rng.normal()
        bearings = bearings_of(BUMP, true, np.linspace(8.0, 25.5, 30), SIGMA, rng)
        found = fit(BUMP, bearings, start_of(BUMP, 29.7), PRIOR, [], SETTINGS, 6)
        nees.append((found.state[X] - 30.0) ** 2 / found.covariance[X, X])
    assert 0.25 < np.mean(nees) < 1.3


def test_cut_edges_are_left_out():
    true = start_of(BUMP, 30.0)
    bearings = bearings_of(BUMP, true, np.linspace(8.0, 25.0, 20))
    cut = [s._replace(bottom=float("nan")) if i > 15 else s for i, s in enumerate(bearings)]
    found = fit(BUMP, cut, true, PRIOR, [], SETTINGS)
    assert np.isfinite(found.state).all()
    assert found.sigma_m > fit(BUMP, bearings, true, PRIOR, [], SETTINGS).sigma_m


def test_a_direct_measurement_pins_its_state():
    bearings = bearings_of(BUMP, start_of(BUMP, 30.0), np.linspace(8.0, 20.0, 10))
    found = fit(BUMP, bearings, start_of(BUMP, 30.0), PRIOR, [DirectMeasurement(X, 30.2, 1e-4)], SETTINGS, 6)
    assert found.state[X] == pytest.approx(30.2, abs=1e-3)


def test_silhouette_is_the_brute_force_maximum():
    rng = np.random.default_rng(0)
    for kind in (BUMP, HUMP, POTHOLE):
        state = start_of(kind, 10.0)
        camera_x = rng.uniform(-10.0, 7.0, 20)
        ahead, below, _ = silhouette(kind, state, camera_x, np.full(20, 1.3))
        share = np.linspace(0.0, 1.0, 4001)
        fine = np.arctan2(
            1.3 - state[HEIGHT] * unit_profile(kind, share, state[LENGTH]),
            state[X] + share * state[LENGTH] - camera_x[:, None],
        ).min(axis=1)
        np.testing.assert_allclose(np.arctan2(below, ahead), fine, atol=3e-4)  # a seventh of a pixel


@pytest.mark.parametrize("bottom", [0.002, 0.0, -0.02])
def test_lines_of_sight_at_the_horizon_or_above_say_far_away_and_no_more(bottom):
    """Such boxes occur on a climb ahead: they do not intersect the plane, and a fit must not diverge."""
    bearings = [
        EdgeBearings(0.0, 10.0 + 0.5 * k, 1.2, bottom, bottom - 0.002, 0.002, 0.002) for k in range(6)
    ]
    state = start_of(BUMP, 30.0)
    for _ in range(12):
        found = fit(BUMP, bearings, state, PRIOR, [], SETTINGS, 2)
        state = found.state
    assert 80.0 < state[X] < 120.0
    assert np.isfinite(found.covariance).all()
    assert np.isfinite(found.cost)


@pytest.mark.parametrize("kind", [BUMP, HUMP, POTHOLE])
def test_the_cost_is_the_negative_logarithm_of_the_evidence(kind):
    """For one direct measurement of the position: its normal density about the start is exact.

    The densities of a fit lack the normalisation of the data's own sigmas but for direct ones.
    """
    start = start_of(kind, 20.0)
    unseen = bearings_of(kind, start, np.array([10.0]))[0]._replace(bottom=np.nan, top=np.nan)
    costs = []
    for height_off in (0.0, 2.0):
        place = DirectMeasurement(X, 20.0, 0.1)
        other = DirectMeasurement(
            HEIGHT, kind.height_m + height_off * kind.height_sigma_m, 0.5 * kind.height_sigma_m
        )
        costs.append(fit(kind, [unseen], start, PRIOR, [place, other], SETTINGS, 2).cost)
    # A second measurement of the height, two prior sigmas off, has the variance 1 + 0.25 about its mean.
    assert costs[1] - costs[0] == pytest.approx(0.5 * 2.0**2 / 1.25, rel=1e-6)


def test_a_vaguer_prior_of_the_height_is_paid_for():
    """Evidence of a height measured at the mean: density of variance prior plus measurement."""
    start = start_of(BUMP, 20.0)
    unseen = bearings_of(BUMP, start, np.array([10.0]))[0]._replace(bottom=np.nan, top=np.nan)
    measured = [DirectMeasurement(X, 20.0, 0.1), DirectMeasurement(HEIGHT, BUMP.height_m, 0.01)]
    costs = [
        fit(replace(BUMP, height_sigma_m=sigma), [unseen], start, PRIOR, measured, SETTINGS, 2).cost
        for sigma in (0.015, 0.06)
    ]
    expected = np.log(np.hypot(0.06, 0.01) / np.hypot(0.015, 0.01))
    assert costs[1] - costs[0] == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize(("pulled_m", "reached_m"), [(-500.0, 8.0 - 10.0), (900.0, 24.0 + 100.0)])
def test_an_edge_stays_within_ten_metres_behind_and_a_hundred_ahead_of_the_cameras(pulled_m, reached_m):
    unseen = [
        EdgeBearings(0.0, camera_x, 1.3, np.nan, np.nan, SIGMA, SIGMA) for camera_x in (8.0, 16.0, 24.0)
    ]
    pulled = [DirectMeasurement(X, pulled_m, 1e-3)]
    assert fit(BUMP, unseen, start_of(BUMP, 30.0), PRIOR, pulled, SETTINGS, 2).state[X] == reached_m


LIMITS = [
    (OFFSET, -0.1, 0.1), (GROUND, -0.2, 0.2), (LENGTH, 0.1, 9.0), (HEIGHT, 0.01, 0.3),
    (EDGE_BIAS, -0.03, 0.03),
]  # fmt: skip


@pytest.mark.parametrize(("entry", "low", "high"), LIMITS)
def test_other_states_stay_within_what_roads_and_mountings_can_be(entry, low, high):
    for value, limit in ((-50.0, low), (50.0, high)):
        pulled = [DirectMeasurement(X, 30.0, 0.1), DirectMeasurement(entry, value, 1e-6)]
        assert fit(BUMP, [], start_of(BUMP, 30.0), PRIOR, pulled, SETTINGS, 2).state[entry] == limit


def test_only_points_more_than_five_centimetres_ahead_are_on_the_silhouette():
    """A camera that stands over a table, its end 7 cm ahead, and one from which it is 3 cm."""
    state = start_of(TABLE, 10.0)
    end_m = 10.0 + TABLE.length_m
    ahead, _, share = silhouette(TABLE, state, np.array([end_m - 0.07, end_m - 0.03]), np.full(2, 1.3))
    assert share.tolist() == [1.0, 0.0]
    assert ahead[0] == pytest.approx(0.07)
