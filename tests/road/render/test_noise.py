"""Random fields: shape, spectrum and repeatability."""

import numpy as np

from foreride.road.render.noise import GRAIN_CELLS, fractal, grain


def test_fractal_has_the_shape_and_repeats() -> None:
    one, other = (fractal(np.random.default_rng(1), (37, 90), (1.0, 0.5, 0.2)) for _ in range(2))
    assert one.shape == (37, 90)
    assert one.dtype == np.float32
    np.testing.assert_array_equal(one, other)


def test_coarse_octaves_are_smooth_and_the_finest_is_white() -> None:
    rng = np.random.default_rng(2)
    smooth = fractal(rng, (200, 200), (1.0, 0.0, 0.0, 0.0, 0.0))
    white = fractal(rng, (200, 200), (0.0, 0.0, 0.0, 0.0, 1.0))
    neighbours = [float(np.corrcoef(f[:, :-1].ravel(), f[:, 1:].ravel())[0, 1]) for f in (smooth, white)]
    assert neighbours[0] > 0.98
    assert abs(neighbours[1]) < 0.05


def test_grain_is_normalised_and_periodic() -> None:
    field = grain(np.random.default_rng(3))
    assert field.shape == (GRAIN_CELLS, GRAIN_CELLS)
    assert abs(field.mean()) < 1e-3
    assert abs(field.std() - 1) < 1e-3
    inside = np.abs(np.diff(field, axis=0)).mean()
    assert np.abs(field[0] - field[-1]).mean() < 1.3 * inside
