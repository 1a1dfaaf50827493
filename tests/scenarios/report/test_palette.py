"""The palette tells controllers apart for every colour vision, on light and on dark pages."""

from itertools import combinations

import numpy as np
import pytest

from foreride.scenarios.report.palette import (
    CONTROLLER_COLOURS,
    DASHES,
    OTHER_COLOURS,
    colours_of,
    dashes_of,
)

SIGHT = {  # Machado, Oliveira, Fernandes 2009: complete dichromacy, on linear RGB
    "normal": np.eye(3),
    "protanopia": np.array(
        [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]]
    ),
    "deuteranopia": np.array(
        [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]]
    ),
    "tritanopia": np.array(
        [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]]
    ),
}
PAGES = ("#ffffff", "#1c2026")


def linear(colour: str) -> np.ndarray:
    channels = np.array([int(colour[at : at + 2], 16) for at in (1, 3, 5)]) / 255
    return np.where(channels <= 0.04045, channels / 12.92, ((channels + 0.055) / 1.055) ** 2.4)


def luminance(colour: str) -> float:
    return float(linear(colour) @ [0.2126, 0.7152, 0.0722])


def lab(rgb: np.ndarray) -> np.ndarray:
    to_xyz = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])
    xyz = to_xyz @ np.clip(rgb, 0, 1) / [0.9505, 1.0, 1.089]
    f = np.where(xyz > 0.008856, np.cbrt(xyz), 7.787 * xyz + 16 / 116)
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


@pytest.mark.parametrize("sight", SIGHT)
def test_the_usual_controllers_differ_for_every_sight(sight: str) -> None:
    usual = [CONTROLLER_COLOURS[name] for name in ("passive", "skyhook", "mpc_reactive", "mpc_preview")]
    seen = [lab(SIGHT[sight] @ linear(colour)) for colour in usual]
    assert min(np.linalg.norm(a - b) for a, b in combinations(seen, 2)) > 18


@pytest.mark.parametrize("page", PAGES)
def test_every_colour_stands_out_from_the_page(page: str) -> None:
    for colour in (*CONTROLLER_COLOURS.values(), *OTHER_COLOURS):
        dark, light = sorted((luminance(colour), luminance(page)))
        assert (light + 0.05) / (dark + 0.05) >= 3.0, colour


def test_a_controller_has_its_colour_whatever_it_is_compared_with() -> None:
    for controllers in (["mpc_preview"], ["own.py:Law", "mpc_preview", "add"], ["add", "mpc_preview"]):
        assert colours_of(controllers)["mpc_preview"] == CONTROLLER_COLOURS["mpc_preview"]
    mixed = colours_of(["own.py:Law", "passive", "add", "own.py:Law"])
    assert [mixed["own.py:Law"], mixed["add"]] == list(OTHER_COLOURS[:2])
    assert len(set(mixed.values())) == 3


def test_perceptions_of_one_controller_differ_by_dashes() -> None:
    variants = [("mpc_preview", "oracle"), ("passive", "none"), ("mpc_preview", "camera")]
    assert list(dashes_of(variants).values()) == [DASHES[0], DASHES[0], DASHES[1]]
