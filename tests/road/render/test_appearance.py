"""Appearance: validated fields, reproducible draws that reach every choice."""

import numpy as np
import pytest

from foreride.files.errors import InputError
from foreride.road.render.appearance import (
    LIGHTS,
    SURFACES,
    SURROUNDINGS,
    VERGES,
    WEATHERS,
    Appearance,
    random_appearance,
)


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("light", "dawn"),
        ("wear", 1.5),
        ("brightness", float("nan")),
        ("left_edge_m", -2.0),
        ("edge_lines", 1),
    ],
)
def test_bad_field_is_named(field: str, value: object) -> None:
    with pytest.raises(InputError, match=f"^{field} must (be|lie in) "):
        Appearance(**{field: value})  # type: ignore[arg-type]


def test_draws_repeat_with_their_seed() -> None:
    first, second = (random_appearance(np.random.default_rng(4)) for _ in range(2))
    assert first == second
    assert first != random_appearance(np.random.default_rng(5))


def test_draws_reach_every_choice() -> None:
    rng = np.random.default_rng(0)
    looks = [random_appearance(rng) for _ in range(300)]
    assert {look.light for look in looks} == set(LIGHTS)
    assert {look.weather for look in looks} == set(WEATHERS)
    assert {look.surface for look in looks} == set(SURFACES)
    assert {look.verge for look in looks} == set(VERGES)
    assert {look.surroundings for look in looks} == set(SURROUNDINGS)
    assert all(look.right_edge_m < -1.4 < 1.4 < look.left_edge_m for look in looks)


def test_a_glare_means_a_sun_in_the_picture_and_street_lamps_mean_night() -> None:
    rng = np.random.default_rng(1)
    looks = [random_appearance(rng) for _ in range(600)]
    glaring = [look for look in looks if look.glare]
    assert glaring
    assert all(abs(look.sun_azimuth_deg) <= 35 and look.light == "sunset" for look in glaring)
    assert all(look.light == "night" for look in looks if look.street_lamps)
