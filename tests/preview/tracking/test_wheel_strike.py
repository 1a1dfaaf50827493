import numpy as np
import pytest

from foreride.preview.obstacle_classes import BUMP, POTHOLE, TABLE
from foreride.preview.settings import Settings
from foreride.preview.tracking.mounting_filter import Calibration
from foreride.preview.tracking.obstacle_templates import tyre_profile
from foreride.preview.tracking.track import Edge, Track, first_fits
from foreride.preview.tracking.wheel_strike import WheelStrikeDetector
from foreride.road.features.feature import HalfSineBump, Pothole
from foreride.road.road import Road
from tests.preview.kinematic_drive import Drive, drive

SETTINGS = Settings()


def track(kind, x, sigma=0.06):
    prior = Calibration(SETTINGS, 457.0).prior(kind.cls)
    fits = tuple(f for f in first_fits(kind.cls, x, sigma, prior) if f.kind is kind)
    match = Track(0, kind.cls, 0.0, 5.0, Edge(0.25, 0.01), Edge(1.25, 0.01), fits)
    match.confirmed = True
    return match


def driven_over(kind, true_x, noise=0.0, step=0.05, level=0.02, hang=np.inf):
    """Wheel that has rolled over an object at `true_x` on a road `level` high."""
    rng = np.random.default_rng(4)
    wheel = WheelStrikeDetector(0.75, SETTINGS)
    at, profile = tyre_profile(kind, kind.length_m, kind.height_m)
    for x in np.arange(true_x - 3.0, true_x + 3.0, step):
        height = max(float(np.interp(x - true_x, at, profile)), -hang)
        wheel.update(x, level + height + noise * rng.normal())
    return wheel


@pytest.mark.parametrize("kind", [BUMP, TABLE, POTHOLE])
@pytest.mark.parametrize("shift", [-0.15, 0.0, 0.1])
def test_a_strike_tells_where_the_edge_is(kind, shift):
    assumed = track(kind, 20.0 - shift)
    wheel = driven_over(kind, 20.0, noise=0.001)
    assert wheel.due(assumed)
    assert wheel.compare(assumed).value == pytest.approx(20.0, abs=0.03)


def test_a_wheel_that_hangs_over_the_hole_still_tells():
    assert driven_over(POTHOLE, 20.0, hang=0.025).compare(track(POTHOLE, 19.9)).value == pytest.approx(
        20.0, abs=0.03
    )


def test_no_strike_no_correction():
    wheel = WheelStrikeDetector(0.75, SETTINGS)
    rng = np.random.default_rng(1)
    for x in np.arange(17.0, 23.0, 0.05):
        wheel.update(x, 0.003 * rng.normal())
    assert wheel.compare(track(BUMP, 20.0)) is None


def test_a_strike_too_far_away_is_another_object():
    assert driven_over(BUMP, 20.0).compare(track(BUMP, 20.6)) is None


def test_nothing_is_due_before_the_wheel_has_passed():
    wheel = WheelStrikeDetector(0.75, SETTINGS)
    wheel.update(19.9, 0.0)
    assert not wheel.due(track(BUMP, 20.0))
    wheel.update(21.5, 0.0)
    assert wheel.due(track(BUMP, 20.0))


@pytest.mark.parametrize(
    "feature",
    [HalfSineBump(40.0, 0.08, 0.4), Pothole(40.0, 0.05, 0.5, 0.6, y_m=0.75)],
    ids=lambda feature: feature.kind,
)
def test_the_rear_wheel_profits_from_the_front_wheel(feature):
    """After the front wheel's strike, 1.2 m before the rear wheel, the error is a few centimetres."""
    shots = [drive(Road(60.0, (feature,)), Drive(seed=s), before_m=-1.5)[0][0] for s in range(5)]
    assert max(abs(shot.error_m) for shot in shots) < 0.05
    assert max(shot.sigma_m for shot in shots) < 0.03


@pytest.mark.parametrize(("height", "found"), [(0.5, False), (0.55, True)])
def test_a_match_explains_three_fifths_of_the_measured_squares(height, found):
    """A bump of half the expected height explains 0.47 of them at the best shift, of 0.55 of it 0.65."""
    lower = type(BUMP)(**(vars(BUMP) | {"height_m": 0.02}))
    wheel = WheelStrikeDetector(0.75, SETTINGS)
    at, profile = tyre_profile(lower, lower.length_m, 0.02)
    for x in np.arange(17.0, 23.0, 0.01):
        wheel.update(x, height * float(np.interp(x - 20.0, at, profile)))
    expected = track(BUMP, 20.0)
    expected.fits = tuple(
        fit._replace(kind=lower, state=np.where(np.arange(6) == 4, 0.02, fit.state)) for fit in expected.fits
    )
    assert (wheel.compare(expected) is not None) == found


def test_the_correction_is_as_certain_as_the_settings_say():
    measurement = driven_over(BUMP, 20.0).compare(track(BUMP, 19.95))
    assert (measurement.entry, measurement.sigma) == (0, SETTINGS.hit_sigma_m)


@pytest.mark.parametrize(("beyond_m", "due"), [(-0.01, False), (0.01, True)])
def test_the_wheel_must_be_half_a_metre_past_the_near_flank(beyond_m, due):
    """The flank is half of the length, and 0.6 m at most."""
    for kind in (BUMP, TABLE):
        wheel, assumed = WheelStrikeDetector(0.75, SETTINGS), track(kind, 20.0)
        wheel.update(20.0 + min(0.5 * kind.length_m, 0.6) + SETTINGS.hit_gate_m + beyond_m, 0.0)
        assert wheel.due(assumed) == due


def test_twelve_metres_of_road_are_kept():
    wheel = WheelStrikeDetector(0.75, SETTINGS)
    for x in np.arange(0.0, 30.0, 0.5):
        wheel.update(x, 0.0)
    assert wheel._path[0][0] == pytest.approx(29.5 - 12.0)


def test_a_track_beside_the_wheel_is_not_compared():
    wheel = driven_over(BUMP, 20.0)
    beside = track(BUMP, 20.0)
    beside.right.y_m, beside.left.y_m = 0.8, 1.8
    assert wheel.compare(beside) is None
    beside.right.y_m = 0.7
    assert wheel.compare(beside) is not None
