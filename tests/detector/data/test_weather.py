"""Weather effects against their optical models."""

from collections.abc import Callable

import numpy as np
import pytest

from foreride.detector.data.corruptions import EFFECTS
from foreride.detector.data.weather import fog, motion_blur, rain, snow

ROAD = np.random.default_rng(0).integers(40, 200, (192, 320, 3)).astype(np.uint8)
BLACK = np.zeros_like(ROAD)


@pytest.mark.parametrize("name", EFFECTS)
@pytest.mark.parametrize("strength", [0.0, 0.5, 1.0])
def test_effects_repeat_and_leave_their_input_alone(name: str, strength: float) -> None:
    before = ROAD.copy()
    one, two = (EFFECTS[name](ROAD, strength, np.random.default_rng(3)) for _ in range(2))
    assert np.array_equal(ROAD, before)
    assert np.array_equal(one, two)
    assert one.shape == ROAD.shape
    assert one.dtype == np.uint8
    assert not np.array_equal(one, ROAD)
    assert not np.array_equal(one, EFFECTS[name](ROAD, strength, np.random.default_rng(4)))


def test_fog_takes_contrast_by_one_factor_a_row_the_less_the_nearer() -> None:
    board = np.where(np.arange(320) % 2, 160, 60)[None, :, None] * np.ones((192, 1, 3))
    shown = fog(board.astype(np.uint8), 0.6, np.random.default_rng(1)).astype(float)
    contrast = (shown[:, 1::2] - shown[:, ::2]) / 100
    assert np.ptp(contrast, axis=1).max() <= 0.011  # one factor a row, but for rounding
    by_row = contrast.mean((1, 2))
    assert (np.diff(by_row) > -0.011).all()
    assert by_row[-1] > 2 * by_row[0] > 0


def test_denser_fog_takes_more() -> None:
    spread = [fog(ROAD, s, np.random.default_rng(1)).std() for s in (0.0, 0.5, 1.0)]
    assert ROAD.std() > spread[0] > spread[1] > spread[2]


def test_rain_falls() -> None:
    drops = rain(BLACK, 0.8, np.random.default_rng(2)).astype(float).mean(2)
    across, down = np.abs(np.diff(drops, axis=1)).sum(), np.abs(np.diff(drops, axis=0)).sum()
    assert across > 1.5 * down  # streaks are longer than wide, and near upright


@pytest.mark.parametrize("effect", [rain, snow])
def test_more_of_it_falls_with_strength(effect: Callable) -> None:
    light = [float(effect(BLACK, s, np.random.default_rng(2)).mean()) for s in (0.0, 0.5, 1.0)]
    assert 0 < light[0] < light[1] < light[2]


def test_snow_whitens_the_road_by_day_and_less_by_night() -> None:
    day, night = np.full_like(ROAD, 120), np.full_like(ROAD, 15)
    gained = [snow(road, 0.7, np.random.default_rng(0)).mean() - road.mean() for road in (day, night)]
    assert gained[0] > 1.2 * gained[1] > 0


@pytest.mark.parametrize(("strength", "length"), [(0.0, 3), (0.5, 9), (1.0, 15)])
def test_motion_blur_draws_a_point_into_a_line(strength: float, length: float) -> None:
    image = np.zeros((385, 641, 3), np.uint8)
    image[192, 320] = 255
    shown = motion_blur(image, strength, np.random.default_rng(5)).astype(float)[..., 0]
    assert shown.sum() == pytest.approx(255, rel=0.15)  # light is spread, not lost; bytes round
    rows, columns = np.nonzero(shown > 3)
    spread = np.linalg.svd(np.c_[rows - rows.mean(), columns - columns.mean()])[1]
    extent = np.hypot(np.ptp(rows), np.ptp(columns))
    assert extent == pytest.approx(length, abs=2)
    assert spread[1] < 0.5 * spread[0]
