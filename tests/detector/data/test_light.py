"""Light of training views: other exposure and colours, shadows and haze, repeatable and of stated shares."""

import numpy as np
import pytest

from foreride.detector.data import light
from foreride.detector.data.light import coloured, hazy, shadowed

ROAD = np.random.default_rng(0).integers(60, 200, (96, 160, 3)).astype(np.uint8)


@pytest.mark.parametrize("effect", [coloured, shadowed, hazy])
def test_an_effect_repeats_with_its_seed_and_leaves_its_input(effect: object) -> None:
    before = ROAD.copy()
    for seed in range(20):
        one, two = (effect(ROAD, np.random.default_rng(seed)) for _ in range(2))  # type: ignore[operator]
        assert np.array_equal(one, two)
        assert one.shape == ROAD.shape
        assert one.dtype == np.uint8
    assert np.array_equal(before, ROAD)


@pytest.mark.parametrize(("effect", "share"), [(shadowed, light.SHADOWED), (hazy, light.HAZY)])
def test_the_stated_share_of_images_changes(effect: object, share: float) -> None:
    rng, count = np.random.default_rng(1), 1500
    small = ROAD[::8, ::8]
    changed = sum(effect(small, rng) is not small for _ in range(count))  # type: ignore[operator]
    assert abs(changed / count - share) < 4 * np.sqrt(share * (1 - share) / count)


def test_a_shadow_darkens_and_never_brightens() -> None:
    least = 1.0
    for seed in range(60):
        image = shadowed(ROAD, np.random.default_rng(seed))
        assert (image <= ROAD).all()
        least = min(least, float((image / ROAD).min()))
    assert 0.28 < least < 0.5


def test_haze_is_denser_towards_the_top() -> None:
    for seed in range(200):
        image = hazy(ROAD, np.random.default_rng(seed))
        if image is not ROAD:
            spread = image.std((1, 2)) / ROAD.std((1, 2))
            assert spread[:10].mean() < spread[-10:].mean() < 1.0


def test_a_hue_turns_about_the_grey_axis() -> None:
    turn = light._hue(0.3)
    np.testing.assert_allclose(turn @ turn.T, np.eye(3), atol=1e-12)
    np.testing.assert_allclose(turn @ np.ones(3), np.ones(3), atol=1e-12)
    assert np.trace(turn) == pytest.approx(1 + 2 * np.cos(0.3))


def test_a_tenth_of_the_images_is_grey() -> None:
    rng = np.random.default_rng(2)
    colour = np.dstack([np.full((4, 4), value, np.uint8) for value in (90, 120, 150)])
    spread = [int(np.ptp(coloured(colour, rng)[0, 0].astype(int))) for _ in range(600)]
    assert 0.06 < np.mean([value <= 1 for value in spread]) < 0.16
