"""Plane fit: apparent structure of rotation errors between two exposures."""

from dataclasses import replace

import numpy as np
import pytest

from foreride.preview.height.plane_fit import _rotations, fit_plane
from foreride.preview.height.plane_parallax import ImageBand, StructureField, band, project_structure
from foreride.road.camera.pinhole import Camera, CameraPose

CAMERA = Camera()
NOW = CameraPose(26.0, 0.1, 1.2, 0.0, 0.0, 0.0)
EARLIER = CameraPose(24.8, 0.0, 1.19, 0.0, 0.0, 0.0)


def seen(**error: float) -> tuple[ImageBand, StructureField]:
    """Band and structure as found along the epipolar line, for another attitude of the earlier exposure."""
    view, true = (
        band(CAMERA, NOW, pose, (250, 370), (100, 540)) for pose in (EARLIER, replace(EARLIER, **error))
    )
    ones, step = np.ones_like(view.ahead), np.float32(1e-3)
    at, ends_at, begins_at, displaced = (
        np.stack(project_structure(CAMERA, geometry, q)[:2])
        for geometry, q in ((view, ones), (view, ones + step), (view, ones - step), (true, ones))
    )
    along = (ends_at - begins_at) / (2.0 * step)
    apparent = ((displaced - at) * along).sum(axis=0) / (along**2).sum(axis=0)
    return view, StructureField(1.0 + apparent, 400.0 * ones, along, 1.0)


@pytest.mark.parametrize(("number", "axis", "sign"), [(0, "pitch", 1.0), (1, "yaw", -1.0)])
def test_apparent_structure_of_a_rotation_is_that_of_displaced_points(
    number: int, axis: str, sign: float
) -> None:
    view, field = seen(**{axis: 1e-3})
    rates = sign * _rotations(CAMERA, view, field)[number]
    np.testing.assert_allclose(rates, 1e3 * (field.q - 1.0), atol=0.01 * np.abs(rates).max())


@pytest.mark.parametrize("error", [{"pitch": 4e-4}, {"yaw": 4e-4}, {"pitch": -2e-4, "yaw": 3e-4}])
def test_a_rotation_between_the_exposures_is_not_taken_for_height(error: dict[str, float]) -> None:
    view, field = seen(**error)
    plane, rotation_q = fit_plane(CAMERA, view, field, np.ones(view.ahead.shape, bool), turns=True)
    raw_m, cleaned_m = (
        view.height_m * np.abs(q).max() for q in (field.q - 1.0, field.q - rotation_q - plane)
    )
    assert raw_m > 0.015
    assert cleaned_m < 0.1 * raw_m


def robust_plane(view: ImageBand, field: StructureField, road: np.ndarray) -> np.ndarray:
    """Every second row and eighth column, by stacked least squares: four steps of Cauchy weights, a prior."""
    rows = np.zeros(road.shape, bool)
    rows[::2, ::8] = True
    chosen = rows & road
    basis = np.stack([view.ahead[chosen], view.side[chosen], view.up[chosen]], axis=1).astype(float)
    value, pixels = field.q[chosen].astype(float) - 1.0, field.pixels[chosen].astype(float)
    texture = np.minimum(field.weight[chosen] / np.median(field.weight[chosen]), 3.0)
    found = np.zeros(3)
    for _ in range(4):
        residual_px = (value - basis @ found) * pixels
        root = pixels / 0.5 * np.sqrt(texture / (1.0 + (residual_px / 0.5) ** 2))
        table = np.vstack([basis * root[:, None], np.eye(3) / 0.02])
        found = np.linalg.lstsq(table, np.concatenate([value * root, np.zeros(3)]), rcond=None)[0]
    return np.asarray(1.0 + found[0] * view.ahead + found[1] * view.side + found[2] * view.up)


@pytest.mark.parametrize("bare", [1.0, 0.5])
def test_the_plane_is_that_of_robust_least_squares_about_the_nominal_one(bare: float) -> None:
    """A tilted plane with an object on half of the rows, and texture of very different strength."""
    rng, view = np.random.default_rng(5), band(CAMERA, NOW, EARLIER, (250, 310), (100, 420))
    tilt = 1.0 + 0.01 * view.ahead / 5.0 + 0.02 * view.side + 0.01 * view.up
    q = (tilt + 0.004 * rng.normal(size=tilt.shape)).astype(np.float32)
    q[20:40] += np.float32(0.05)
    weight = rng.lognormal(3.0, 1.5, tilt.shape).astype(np.float32)
    along = np.stack([100.0 + 40.0 * rng.random(tilt.shape), 30.0 * rng.random(tilt.shape)]).astype(
        np.float32
    )
    field, road = StructureField(q, weight, along, 1.0), np.ones(tilt.shape, bool)
    road[round(bare * len(road)) :] = False
    plane, rotation_q = fit_plane(CAMERA, view, field, road, turns=False)
    np.testing.assert_allclose(plane, robust_plane(view, field, road), rtol=1e-5)
    assert not rotation_q.any()


def test_without_any_road_the_plane_is_the_nominal_one() -> None:
    view, field = seen(pitch=0.01)
    plane, _ = fit_plane(CAMERA, view, field, np.zeros(view.ahead.shape, bool), turns=False)
    np.testing.assert_allclose(plane, 1.0)
