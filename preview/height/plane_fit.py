"""Road-plane fit: robust estimate of the plane, and of rotation errors, in a field of structure."""

import numpy as np

from foreride.preview.height.plane_parallax import ImageBand, StructureField
from foreride.road.camera.pinhole import Camera

Array = np.ndarray
_SAMPLING = (slice(None, None, 2), slice(None, None, 8))
_ITERATIONS = 4
_NOISE_PX = 0.5  # noise of one sample, inflated because neighbouring windows overlap
_CAUCHY = 1.0
_MAX_WEIGHT = 3.0  # limit of a weight over the median: road paint has strong gradients and must not dominate
_TILT_SIGMA = 0.02  # of the plane's inverse distance, 1/m: 2 % of grade or banking, 3 cm of camera height
_ROTATION_SIGMA = 0.0003  # rad, error of the rotation between two exposures of one camera


def fit_plane(
    camera: Camera, view: ImageBand, field: StructureField, road: Array, turns: bool
) -> tuple[Array, Array]:
    """(plane, turned), both (rows, columns): structure q of the plane, and apparent q of a rotation error.

    road: (rows, columns) bool, pixels without known objects. turns: whether to estimate an error of the
    rotation between the two images. Weighted robust least squares with priors around the nominal plane: its
    inverse distance is linear in the pixel, so q - 1 = a ahead + b side + c up.
    """
    basis = np.stack([view.ahead, view.side, view.up, *(_rotations(camera, view, field) if turns else ())])
    sigma = np.array([_TILT_SIGMA] * 3 + [_ROTATION_SIGMA] * (len(basis) - 3))
    mask = road[_SAMPLING].ravel()
    columns = basis[(slice(None), *_SAMPLING)].reshape(len(basis), -1)[:, mask].astype(float)
    value, weight, pixels = (
        part[_SAMPLING].ravel()[mask].astype(float) for part in (field.q - 1.0, field.weight, field.pixels)
    )
    median_weight = float(np.median(weight)) if len(weight) else 1.0
    scale = (pixels / _NOISE_PX) ** 2 * np.minimum(weight / max(median_weight, 1e-9), _MAX_WEIGHT)
    coefficients = np.zeros(len(basis))
    for _ in range(_ITERATIONS):
        normalised_residual = (value - coefficients @ columns) * pixels / _NOISE_PX / _CAUCHY
        weighted = columns * (scale / (1.0 + normalised_residual**2))
        coefficients = np.linalg.solve(weighted @ columns.T + np.diag(sigma**-2), weighted @ value)
    plane = 1.0 + np.tensordot(coefficients[:3], basis[:3], axes=1)
    rotation_q = np.tensordot(coefficients[3:], basis[3:], axes=1) if turns else np.zeros_like(plane)
    return plane.astype(np.float32), rotation_q.astype(np.float32)


def _rotations(camera: Camera, view: ImageBand, field: StructureField) -> list[Array]:
    """Apparent q per rad of pitch and of yaw error of the other camera, along the epipolar line."""
    forward, left, up = view.other + view.travel[:, None, None]
    x, y = left / forward, up / forward
    flows = [(-x * y, -(1.0 + y * y)), (-(1.0 + x * x), -x * y)]
    scale = np.float32(camera.focal_px) / field.pixels**2
    return [scale * (u * field.along[0] + v * field.along[1]) for u, v in flows]
