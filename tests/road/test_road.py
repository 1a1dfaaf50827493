import numpy as np
import pytest

from foreride.files.errors import InputError
from foreride.road.features.feature import FlatTopHump, HalfSineBump, Pothole
from foreride.road.road import FADE_IN_M, Road
from foreride.road.roughness.iso8608 import Roughness, rough_surface

BUMP, HOLE = HalfSineBump(20.0, 0.08, 0.4), Pothole(8.0, 0.05, 0.3, 0.4, y_m=0.75)


def test_flat_road_is_flat():
    assert not Road(10.0).height(np.linspace(-5, 15, 50)[:, None], [-1.0, 1.0]).any()


def test_features_come_in_order_and_give_their_heights():
    road = Road(50.0, (BUMP, HOLE))
    assert road.features == (HOLE, BUMP)
    x, y = np.linspace(0, 50, 2001)[:, None], np.linspace(-4, 4, 17)
    np.testing.assert_allclose(road.height(x, y), BUMP.height(x, y) + HOLE.height(x, y), atol=1e-12)


def test_overlapping_features_add_up():
    table, hole = FlatTopHump(10.0), Pothole(11.0, 0.05, 0.6, 0.6)
    assert Road(30.0, (table, hole)).height(11.3, 0.0) == pytest.approx(0.09 - 0.05)


def test_roughness_fades_in_and_goes_on_beyond_the_end():
    road = Road(40.0, roughness=Roughness("D", 3))
    x = np.linspace(-5, 60, 1301)
    z = road.height(x, 0.75)
    assert not z[x <= 0].any()
    surface = rough_surface(Roughness("D", 3), 40.0)
    beyond = x >= FADE_IN_M
    np.testing.assert_allclose(z[beyond], surface.height(x[beyond], 0.75), atol=1e-12)
    assert np.abs(np.diff(z)).max() < 0.05


def test_height_has_the_broadcast_shape():
    road = Road(30.0, (BUMP,), Roughness("A"))
    assert road.height(1.0, 0.0).shape == ()
    assert road.height(np.zeros(4), 0.0).shape == (4,)
    x, y = np.linspace(0, 30, 31)[:, None], np.linspace(-2, 2, 5)
    grid = road.height(x, y)
    assert grid.shape == (31, 5)
    assert grid[7, 3] == road.height(x[7, 0], y[3])


@pytest.mark.parametrize("start", [-0.1, 19.7])
def test_feature_outside_the_road_is_named_with_its_extent_and_the_length(start):
    with pytest.raises(InputError, match=r"features\[1\] \(half_sine_bump\) spans .* length_m = 20 m"):
        Road(20.0, (HOLE, HalfSineBump(start, 0.08, 0.4)))


def test_a_rough_road_has_a_longest_length():
    with pytest.raises(InputError, match="length_m must be <= 32768 m with roughness, got 40000"):
        Road(40_000.0, roughness=Roughness("A"))


@pytest.mark.parametrize("length", [0.0, -1.0, float("inf"), float("nan"), True])
def test_length_must_be_positive(length):
    with pytest.raises(InputError, match=r"^length_m must (be|lie in) "):
        Road(length)
