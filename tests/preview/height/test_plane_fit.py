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
