"""Elementary functions for loops over pixels against NumPy's."""

import numpy as np

from foreride.road.render.fast_math import arctan2, exp_minus, log2_to_64


def test_exponential() -> None:
    x = np.linspace(0.0, 15.0, 301)
    np.testing.assert_allclose([exp_minus(value) for value in x], np.exp(-x), rtol=3e-5, atol=1e-9)
    assert 0 <= exp_minus(1e9) < 2e-7


def test_logarithm() -> None:
    x = np.geomspace(1.0, 64.0, 301)
    np.testing.assert_allclose([log2_to_64(value) for value in x], np.log2(x), atol=4e-5)


def test_arctangent_in_all_directions() -> None:
    angle = np.linspace(-3.14, 3.14, 315)
    found = [arctan2(y, x) for y, x in zip(2 * np.sin(angle), 2 * np.cos(angle), strict=True)]
    np.testing.assert_allclose(found, angle, atol=1e-7)
    assert arctan2(0.0, 0.0) == 0
