from dataclasses import replace

import numpy as np
import pytest

from foreride.files.errors import InputError
from foreride.preview.road_preview import (
    PREVIEW_M,
    RoadPreview,
    distance_grid,
    flat_preview,
    oracle_preview,
    within,
)
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


def test_the_usual_grid_is_ten_metres_ahead_and_half_a_metre_behind_by_25_mm():
    grid = distance_grid()
    np.testing.assert_allclose(grid, 0.025 * np.arange(-20, 401), atol=1e-12)
    assert PREVIEW_M == 10.0
    assert not grid.flags.writeable
    assert flat_preview(1).distance_m is grid
    assert (flat_preview(1).time_s, flat_preview(1).age_s, flat_preview(3).wheels) == (0.0, 0.0, 3)


GRID = distance_grid(0.1, 0.2, 0.05)


def preview(**changes):
    rows = np.arange(14.0).reshape(2, 7) / 20.0
    values = {
        "height_m": rows - 0.3,
        "position_sigma_m": rows,
        "height_sigma_m": 2.0 * rows,
        "existence": rows,
    }
    return RoadPreview(**({"time_s": 1.0, "distance_m": GRID, "age_s": 0.25} | values | changes))


def ones(value):
    """Rows of ones with one other value."""
    rows = np.ones((2, 7))
    rows[1, 3] = value
    return rows


@pytest.mark.parametrize(
    ("name", "valid", "invalid"),
    [
        ("height_m", (-1e300, 1e300), (np.inf, -np.inf, np.nan)),
        ("position_sigma_m", (0.0, 1e300), (-1e-9, np.inf, np.nan)),
        ("height_sigma_m", (0.0, 1e300), (-1e-9, np.inf, np.nan)),
        ("existence", (0.0, 1.0), (-1e-9, 1.0 + 1e-9, np.nan)),
    ],
)
def test_the_fast_check_accepts_what_is_allowed_and_nothing_else(name, valid, invalid):
    """What it does not accept is checked once more, with a message."""
    sound = preview()
    assert sound._is_accepted()
    for value in (*valid, *invalid):
        changed = replace(sound)
        object.__setattr__(changed, name, ones(value))
        assert changed._is_accepted() == (value in valid)
        if value in invalid:
            with pytest.raises(InputError, match="must"):
                replace(sound, **{name: ones(value)})


@pytest.mark.parametrize(
    ("grid", "valid"),
    [
        (GRID, True),
        (GRID[::-1].copy(), False),
        (np.zeros(7), False),
        (GRID + 4e-7 * (np.arange(7) == 3), True),
        (GRID + 6e-7 * (np.arange(7) == 3), False),
        (1e-5 * GRID + 0.9e-9 * (np.arange(7) == 6), True),
        (1e-5 * GRID + 1.2e-9 * (np.arange(7) == 6), False),
    ],
)
def test_steps_are_equal_to_a_hundred_thousandth_and_a_nanometre(grid, valid):
    changed = preview()
    object.__setattr__(changed, "distance_m", grid)
    assert changed._is_accepted() == valid
    if valid:
        assert preview(distance_m=grid).distance_m is grid
    else:
        with pytest.raises(InputError, match="distance_m must ascend in equal steps"):
            preview(distance_m=grid)


def test_other_layouts_are_converted():
    rows = preview().height_m
    for other in (
        rows.astype(np.float32),
        np.asfortranarray(rows),
        rows.tolist(),
        np.repeat(rows, 2, axis=1)[:, ::2],
    ):
        changed = preview()
        object.__setattr__(changed, "height_m", other)
        assert not changed._is_accepted()
        np.testing.assert_allclose(preview(height_m=other).height_m, rows, atol=1e-7)
    for name in ("height_m", "position_sigma_m", "height_sigma_m", "existence"):
        with pytest.raises(InputError, match=r"must have shape \(wheels, 7\)"):
            preview(**{name: np.zeros((2, 6))})
    with pytest.raises(InputError, match=r"distance_m must have shape \(n,\) with n >= 2, got \(1,\)"):
        preview(distance_m=np.zeros(1))


def test_the_near_part_ends_at_its_distance():
    whole = preview()
    near = within(whole, 0.1)
    np.testing.assert_array_equal(near.distance_m, GRID[:5])
    for name in ("height_m", "position_sigma_m", "height_sigma_m", "existence"):
        np.testing.assert_array_equal(getattr(near, name), getattr(whole, name)[:, :5])
    assert (near.time_s, near.age_s) == (1.0, 0.25)
    assert within(whole, 0.2) is within(whole, 9.0) is whole
    assert len(within(whole, 0.0999).distance_m) == 4


def test_all_rows_advance_and_the_age_grows():
    whole = preview()
    moved = whole.advanced(0.05, 1.5)
    for name in ("height_m", "position_sigma_m", "height_sigma_m", "existence"):
        rows = getattr(whole, name)
        np.testing.assert_allclose(getattr(moved, name), np.hstack([rows[:, 1:], rows[:, -1:]]))
    assert (moved.time_s, moved.age_s) == (1.5, 0.75)


def test_only_a_preview_without_any_sigma_is_exact():
    none = np.zeros((2, 7))
    assert preview(position_sigma_m=none, height_sigma_m=none).is_exact
    assert not preview(height_sigma_m=none).is_exact
    assert not preview(position_sigma_m=none).is_exact
    np.testing.assert_allclose(preview().height_here_m, preview().height_m[:, 2])


def test_arrays_whose_type_is_equal_but_another_object_are_not_converted(monkeypatch):
    """Compiled functions return such arrays."""
    grid = distance_grid(0.5, 3.0)
    rows = np.ones((2, len(grid)), np.dtype(float).newbyteorder("="))
    assert rows.dtype is not np.dtype(float)
    monkeypatch.setattr(RoadPreview, "_check", lambda self: pytest.fail("the slow check was taken"))
    assert RoadPreview(0.0, grid, rows, rows, rows, rows).wheels == 2


def test_only_an_exact_preview_of_what_is_there_is_certain() -> None:
    """As the checked constructor finds, and as the one for exact previews takes for granted."""
    true = oracle_preview([wheel_profile(ROAD, 0.75)], [18.0])
    same = RoadPreview.exact(0.0, true.distance_m, true.height_m, true.height_here_m)
    assert true.is_certain
    assert same.is_certain
    assert same.is_exact
    for name in ("position_sigma_m", "height_sigma_m", "existence"):
        np.testing.assert_array_equal(getattr(same, name), getattr(true, name))
    assert not flat_preview(1).is_certain
    assert not replace(true, height_sigma_m=np.full_like(true.height_m, 0.01)).is_certain
    assert not replace(true, existence=np.full_like(true.height_m, 0.99)).is_certain
