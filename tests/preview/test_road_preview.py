import numpy as np
import pytest

from foreride.files.errors import InputError
from foreride.preview.road_preview import RoadPreview, distance_grid, flat_preview, oracle_preview
from foreride.road.features.feature import HalfSineBump
from foreride.road.road import Road
from foreride.road.tyre.wheel_profile import wheel_profile

ROAD = Road(40.0, (HalfSineBump(20.0, 0.08, 0.4),))


def test_grid_contains_both_ends_and_zero():
    grid = distance_grid(0.5, 3.0, 0.05)
    assert grid[0] == -0.5
    assert grid[-1] == pytest.approx(3.0)
    assert 0.0 in grid


def test_flat_preview_knows_nothing():
    preview = flat_preview(2)
    assert preview.wheels == 2
    assert not preview.existence.any()
    assert not preview.height_m.any()


def test_oracle_is_the_profile_at_each_wheel():
    profile = wheel_profile(ROAD, 0.75)
    preview = oracle_preview([profile, profile], [18.0, 15.3], 1.0)
    assert preview.height(0, 2.2) == pytest.approx(profile.height(20.2), abs=2e-4)
    assert preview.height(1, 4.9) == pytest.approx(profile.height(20.2), abs=2e-4)
    assert (preview.existence == 1).all()
    assert not preview.position_sigma_m.any()


def test_advancing_is_the_same_as_looking_again_from_further_on():
    profile = wheel_profile(ROAD, 0.75)
    moved = oracle_preview([profile], [17.0], 1.0).advanced(0.5, 1.05)
    again = oracle_preview([profile], [17.5], 1.05)
    inside = moved.distance_m < 9.0
    np.testing.assert_allclose(moved.height_m[:, inside], again.height_m[:, inside], atol=1e-12)
    assert moved.age_s == pytest.approx(0.05)


def test_beyond_the_grid_the_height_stays():
    profile = wheel_profile(ROAD, 0.75)
    preview = oracle_preview([profile], [10.1])
    assert preview.height(0, 50.0) == preview.height_m[0, -1]


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("distance_m", np.array([0.0, 0.1, 0.3])),
        ("height_m", np.zeros(3)),
        ("height_m", np.full((1, 3), np.nan)),
        ("position_sigma_m", np.full((1, 3), -1.0)),
        ("existence", np.full((1, 3), 1.5)),
    ],
)
def test_names_the_field_that_is_wrong(field, value):
    zero = np.zeros((1, 3))
    values = {
        "time_s": 0.0,
        "distance_m": np.array([0.0, 0.1, 0.2]),
        "height_m": zero,
        "position_sigma_m": zero,
        "height_sigma_m": zero,
        "existence": zero,
    }
    with pytest.raises(InputError, match=field):
        RoadPreview(**{**values, field: value})
