"""Plane-plus-parallax: height of the road over its plane, from two images.

The second image is a second camera's (stereo) or the same camera's a little earlier. A point seen in a pixel
of the reference image lies z above the plane of the road; with the camera h above that plane and q = 1 / (1 -
z/h), it appears in the other image at the projection of
    A + q T,   A = Z R r,   T = translation between the cameras,
where Z r is the plane's point on the pixel's ray: q = 1 is the warp of the plane by its homography, and any
deviation moves the point along the line to the epipole T (Irani & Anandan, Parallax geometry of pairs of
points for 3D scene analysis, ECCV 1996; Sawhney, CVPR 1994). q is found by Gauss-Newton on the brightness
along that line, in windows wide across the road and low along it (Lucas & Kanade, 1981).
"""

from typing import NamedTuple

import cv2
import numpy as np

from foreride.road.camera.pinhole import Camera, CameraPose

Array = np.ndarray
_WINDOW_ROWS = 3  # low windows: objects are homogeneous across the road, edges along it must stay sharp
_MAX_STEP_PX = 1.0
_REGULARISATION = 0.02  # regularisation, (grey level / px)²: weaker gradients carry no information
_MAX_STRUCTURE = 0.2  # limit of |q - 1|


class ImageBand(NamedTuple):
    """Image band of the reference image and the geometry of its pixels, arrays (rows, columns) float32.

    top, left: its first row and column. ahead, side, up: the plane's point on each pixel's ray in axes of the
    reference camera (m). other: (3, rows, columns) the same point in axes of the other camera, forward, left,
    up. travel: (3,) derivative of that point by q. height_m: of the reference camera over the plane.
    """

    top: int
    left: int
    ahead: Array
    side: Array
    up: Array
    other: Array
    travel: Array
    height_m: float


class StructureField(NamedTuple):
    """Structure of a band (q of the module), arrays (rows, columns).

    weight: mean squared gradient along the epipolar line in the window, (grey level / px)². along: (2, rows,
    columns) derivative by q of column and row in the other image. noise: standard deviation of the difference
    of the matched images, grey levels.
    """

    q: Array
    weight: Array
    along: Array
    noise: float

    @property
    def pixels(self) -> Array:
        """Displacement in the other image per unit of q (px)."""
        return np.hypot(*self.along)


def band(
    camera: Camera,
    reference: CameraPose,
    other: CameraPose,
    rows: tuple[int, int],
    columns: tuple[int, int],
) -> ImageBand:
    """Geometry of the pixels in `rows` and `columns` (first, one after last), all below the horizon."""
    v = np.arange(*rows, dtype=np.float32)[:, None] + np.float32(0.5 - camera.cy)
    u = np.arange(*columns, dtype=np.float32)[None, :] + np.float32(0.5 - camera.cx)
    left, up = np.broadcast_arrays(-u / np.float32(camera.focal_px), -v / np.float32(camera.focal_px))
    normal = reference.rotation[2].astype(np.float32)
    ahead = -np.float32(reference.z) / (normal[0] + left * normal[1] + up * normal[2])
    rotation = (other.rotation.T @ reference.rotation).astype(np.float32)
    point = np.stack([ahead, ahead * left, ahead * up])
    travel = other.rotation.T @ (reference.position - other.position)
    other_point = np.tensordot(rotation, point, axes=1).astype(np.float32)
    ground = point[0], point[1], point[2]
    return ImageBand(rows[0], columns[0], *ground, other_point, travel.astype(np.float32), float(reference.z))


def project_structure(camera: Camera, view: ImageBand, q: Array) -> tuple[Array, Array, Array]:
    """Columns and rows (for `cv2.remap`) in the other image of points at structure `q`, and their depth."""
    forward, left, up = (part + q * step for part, step in zip(view.other, view.travel, strict=True))
    scale = np.float32(camera.focal_px) / forward
    return np.float32(camera.cx - 0.5) - scale * left, np.float32(camera.cy - 0.5) - scale * up, forward


def match(
    camera: Camera,
    view: ImageBand,
    image: Array,
    other: Array,
    start: Array,
    window_px: int,
    iterations: int = 3,
) -> StructureField:
    """Refine the structure `start` (rows, columns) by matching `other` (H, W) to `image` (H, W), both grey.

    window_px: width of the windows.
    """
    window = (window_px, _WINDOW_ROWS)
    rows, columns = view.ahead.shape
    reference = image[view.top : view.top + rows, view.left : view.left + columns].astype(np.float32)
    q = start
    for _ in range(iterations):
        at_u, at_v, forward = project_structure(camera, view, q)
        warped = cv2.remap(other, at_u, at_v, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE).astype(
            np.float32
        )
        # Along the epipolar line, by the derivative of `project_structure`, with the gradient of both images.
        scale = np.float32(1.0) / forward
        along_u = scale * (-camera.focal_px * view.travel[1] - (at_u - camera.cx + 0.5) * view.travel[0])
        along_v = scale * (-camera.focal_px * view.travel[2] - (at_v - camera.cy + 0.5) * view.travel[0])
        mean_image = warped + reference
        slope = np.float32(0.25) * (
            cv2.Sobel(mean_image, cv2.CV_32F, 1, 0, ksize=1) * along_u
            + cv2.Sobel(mean_image, cv2.CV_32F, 0, 1, ksize=1) * along_v
        )
        pixels = np.hypot(along_u, along_v)
        error = cv2.blur(slope * (reference - warped), window)
        weight = cv2.blur(slope * slope, window)
        regularised = weight + _REGULARISATION * pixels**2
        max_step = _MAX_STEP_PX / pixels
        q = np.clip(
            q + np.clip(error / regularised, -max_step, max_step), 1.0 - _MAX_STRUCTURE, 1.0 + _MAX_STRUCTURE
        )
        q = cv2.blur(q * regularised, (window_px, 1)) / cv2.blur(regularised, (window_px, 1))
    noise = 1.48 * float(np.median(np.abs(reference - warped)))
    return StructureField(q, weight / pixels**2, np.stack([along_u, along_v]), noise)
