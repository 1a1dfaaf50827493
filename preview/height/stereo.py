"""Stereo heights: semi-global matching of an image band, with both images warped to the road plane.

In the raw pair the road is a slanted surface that semi-global matching (Hirschmueller, PAMI 2008) breaks into
steps. Warped by the plane's homography, the road has zero disparity and objects on it a small one, so that
few disparities at half the resolution suffice; `preview.height.plane_parallax.match` then refines to a tenth
of a pixel.
"""

from dataclasses import replace

import cv2
import numpy as np

from foreride.preview.height.plane_parallax import ImageBand, project_structure
from foreride.road.camera.pinhole import Camera, CameraPose

Array = np.ndarray
_DISPARITIES, _BLOCK = 16, 5


def second_pose(pose: CameraPose, base_m: float) -> CameraPose:
    """Pose of the right camera of a pair whose left one is at `pose`, `base_m` apart, axes parallel."""
    x, y, z = pose.position - base_m * pose.rotation[:, 1]
    return replace(pose, x=float(x), y=float(y), z=float(z))


def coarse(camera: Camera, view: ImageBand, left: Array, right: Array) -> Array:
    """Structure q (rows, columns) of a band by semi-global matching, accurate to about half a pixel."""
    rows, columns = view.ahead.shape
    at_u, at_v, forward = project_structure(camera, view, np.ones_like(view.ahead))
    warped = cv2.remap(right, at_u, at_v, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    reference = left[view.top : view.top + rows, view.left : view.left + columns]
    half_size = (columns // 2, rows // 2)
    matcher = cv2.StereoSGBM.create(
        minDisparity=-_DISPARITIES // 2,
        numDisparities=_DISPARITIES,
        blockSize=_BLOCK,
        P1=8 * _BLOCK**2,
        P2=32 * _BLOCK**2,
        preFilterCap=31,
        mode=cv2.STEREO_SGBM_MODE_SGBM_3WAY,
    )
    small = [cv2.resize(image, half_size, interpolation=cv2.INTER_AREA) for image in (reference, warped)]
    disparity = matcher.compute(*small).astype(np.float32) / 16.0
    disparity[disparity < -_DISPARITIES // 2] = 0.0  # not found
    shift = 2.0 * cv2.resize(disparity, (columns, rows), interpolation=cv2.INTER_NEAREST)
    return 1.0 + shift * forward / np.float32(camera.focal_px * view.travel[1])
