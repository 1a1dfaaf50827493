"""Height measurement of tracked objects in images, by a stereo pair or by one moving camera."""

import warnings
from collections import deque
from typing import NamedTuple

import cv2
import numpy as np

from foreride.preview.height.plane_fit import fit_plane
from foreride.preview.height.plane_parallax import ImageBand, StructureField, band, match
from foreride.preview.height.stereo import coarse, second_pose
from foreride.preview.settings import Settings
from foreride.preview.tracking.height_likelihood import HeightRows, HeightSamples, NearEdge
from foreride.preview.tracking.track import Track
from foreride.road.camera.pinhole import Camera, CameraPose

Array = np.ndarray
_MARGIN_M = 2.0  # road before and behind an object used to find the plane
_BESIDE_M = 0.3  # margin around an object excluded from the plane
_SHADOW = 0.1  # length of road hidden behind a bump, over the distance
_HALF_STRIP_M = 1.5  # half width of the evaluated strip of road
_MIN_ROWS, _MIN_COLUMNS = 12, 64
_HOLE_SIGMA_RATIO = 2.0  # ratio of a hole's near-edge sigma to a bump's
_EVERY_ROW = 2  # row stride: windows of neighbouring rows overlap
_MIN_NOISE_GREY = 1.0  # least noise of the difference of two images
_ROBUST = 2.0  # deviation, in spreads of its row, with half weight
_MIN_SIGMA_PX = 0.05
_WINDOW_M = 0.6  # window width across the road
_MIN_MONO_BASELINE_M = 1.0
_MIN_BARE_SHARE = 0.99  # least weight share of bare road in a row of bare road
_ROW_CORRELATION = (
    2.0  # sigma inflation: errors of neighbouring rows are correlated, which their scatter hides
)
_KEPT = 4


class PosedImage(NamedTuple):
    """Exposure: a grey image (H, W) uint8 and the camera pose."""

    pose: CameraPose
    image: Array


class HeightGauge:
    """Height measurement of every track in range, added to the track's `elevation` in each frame.

    base_m: baseline to the second camera, right of the first; 0 for none, then earlier frames are used.
    """

    def __init__(self, camera: Camera, base_m: float, settings: Settings) -> None:
        self.camera, self.base_m, self.settings = camera.pinhole, base_m, settings
        self._straight = None if camera.is_pinhole else _undistortion_maps(camera)
        self._shots: deque[PosedImage] = deque(maxlen=_KEPT)

    def measure(
        self, pose: CameraPose, image: Array, second: Array | None, tracks: list[Track]
    ) -> list[Track]:
        """Measure in one frame, images (H, W, 3) RGB; returns the tracks with new samples."""
        rows = [self._rows_of(pose, track) for track in tracks]
        in_range = [(track, span) for track, span in zip(tracks, rows, strict=True) if span is not None]
        if second is not None and not in_range:
            return []
        exposure = PosedImage(pose, self.grey(image))
        if second is not None:
            partner = PosedImage(second_pose(pose, self.base_m), self.grey(second))
        else:
            candidates = [s for s in self._shots if pose.x - s.pose.x >= _MIN_MONO_BASELINE_M]
            self._shots.append(exposure)
            if not candidates:
                return []
            partner = candidates[-1]
        stereo = second is not None
        return [t for t, span in in_range if self._measure_one(exposure, partner, stereo, t, span, tracks)]

    def grey(self, image: Array) -> Array:
        """Grey image (H, W), undistorted, of an image (H, W, 3) RGB."""
        grey = cv2.cvtColor(image, cv2.COLOR_RGB2GRAY)
        return grey if self._straight is None else cv2.remap(grey, *self._straight, cv2.INTER_LINEAR)

    def _measure_one(
        self,
        exposure: PosedImage,
        partner: PosedImage,
        stereo: bool,
        track: Track,
        rows: tuple[int, int],
        tracks: list[Track],
    ) -> bool:
        columns = self._columns_of(exposure.pose, rows, track)
        if columns[1] - columns[0] < _MIN_COLUMNS:
            return False
        view = band(self.camera, exposure.pose, partner.pose, rows, columns)
        start = (
            coarse(self.camera, view, exposure.image, partner.image) if stereo else np.ones_like(view.ahead)
        )
        middle = max(0.5 * (track.start_m + track.end_m) - exposure.pose.x, 3.0)
        width_px = 2 * round(0.5 * self._window_m(track) * self.camera.focal_px / middle) + 1
        field = match(self.camera, view, exposure.image, partner.image, start, width_px)
        sample = self._profile(exposure.pose, view, field, stereo, track, tracks)
        if sample is None:
            return False
        if track.elevation is None:
            sigma = self.settings.stereo_shift_sigma_m if stereo else self.settings.parallax_shift_sigma_m
            sigma_ratio = 1.0 if track.best.kind.sign > 0 else _HOLE_SIGMA_RATIO
            track.elevation = HeightSamples(sigma_ratio * sigma, stereo)
        track.elevation.add(*sample)
        return True

    def _window_m(self, track: Track) -> float:
        """Width of the matching window: width over which an object is homogeneous."""
        return _WINDOW_M if track.best.kind.sign > 0 else 0.33 * _WINDOW_M

    def _rows_of(self, pose: CameraPose, track: Track) -> tuple[int, int] | None:
        """Range of rows that shows the object and some road around it, within the method's range."""
        near = max(track.start_m - _MARGIN_M - pose.x, self.settings.gauge_near_m)
        far = min(track.end_m + _MARGIN_M - pose.x, self.settings.gauge_far_m)
        if not track.confirmed or track.start_m - pose.x > self.settings.gauge_far_m or far - near < 1.0:
            return None
        limit = min(self.camera.height_px, int(self.settings.bonnet_row_px))
        bottom, top = (
            self.camera.cy + self.camera.focal_px * np.tan(np.arctan2(pose.z, ahead) - pose.pitch)
            for ahead in (near, far)
        )
        rows = max(int(top), 0), min(int(bottom) + 1, limit)
        return rows if rows[1] - rows[0] >= _MIN_ROWS else None

    def _columns_of(self, pose: CameraPose, rows: tuple[int, int], track: Track) -> tuple[int, int]:
        nearest = pose.z / np.tan(np.arctan2(rows[1] - self.camera.cy, self.camera.focal_px) + pose.pitch)
        scale = self.camera.focal_px / max(float(nearest), 1.0)
        right, left = track.right.y_m - pose.y - 0.5, track.left.y_m - pose.y + 0.5
        span = np.clip([left, right], -_HALF_STRIP_M, _HALF_STRIP_M)
        first, last = (int(self.camera.cx - scale * y) for y in span)
        return max(first, 0), min(last + 1, self.camera.width_px)

    def _profile(
        self,
        pose: CameraPose,
        view: ImageBand,
        field: StructureField,
        stereo: bool,
        track: Track,
        tracks: list[Track],
    ) -> tuple[HeightRows, NearEdge | None] | None:
        """Height sample over the plane for each row on the object's strip, and its near edge."""
        axes = pose.rotation.astype(np.float32)
        point = np.stack([view.ahead, view.side, view.up])
        x, y = (np.tensordot(axes[k], point, axes=1) for k in (0, 1))
        x += np.float32(pose.x)
        y += np.float32(pose.y)
        road = np.ones(x.shape, bool)
        for other in tracks:
            shadow_m = _SHADOW * (other.end_m - pose.x)
            road &= (x < other.start_m - _BESIDE_M) | (x > other.end_m + _BESIDE_M + shadow_m)
        plane, rotation_q = fit_plane(self.camera, view, field, road, turns=not stereo)
        ratio = (field.q - rotation_q) / plane
        right, left = _strip(track, pose)
        on_strip = (y > right) & (y < left)
        weight = np.where(on_strip, field.weight * _homogeneity_weights(ratio, on_strip), 0.0)
        total = weight.sum(axis=1)
        rows_used = np.flatnonzero(total > 0)[::_EVERY_ROW]
        if len(rows_used) < _MIN_ROWS // _EVERY_ROW:
            return None
        share = weight[rows_used] / total[rows_used][:, None]
        mean = (share * ratio[rows_used]).sum(axis=1)
        forward = (share * (x - pose.x)[rows_used] / (plane[rows_used] if stereo else 1.0)).sum(axis=1)
        pixels = (share * field.pixels[rows_used]).sum(axis=1)
        sigma_px = np.hypot(max(field.noise, _MIN_NOISE_GREY) / np.sqrt(total[rows_used]), _MIN_SIGMA_PX)
        slant = forward / view.height_m
        samples = HeightRows(
            pose.x + forward,
            view.height_m * (1.0 - 1.0 / mean),
            view.height_m * sigma_px / pixels,
            3.0 * forward * slant / self.camera.focal_px,
            slant,
        )
        if not stereo:
            bare_rows = (share * road[rows_used]).sum(axis=1) > _MIN_BARE_SHARE
            return samples._replace(sigma_m=samples.sigma_m * _sigma_inflation(samples, bare_rows)), None
        nominal = (x - pose.x)[:, [0, -1]].mean(axis=1)
        return samples, self._edge(track, pose, nominal, np.where(on_strip, plane, 0.0))

    def _edge(self, track: Track, pose: CameraPose, nominal: Array, plane: Array) -> NearEdge | None:
        """Near edge: where the newest box's bottom meets the plane (rows, columns), 0 beside the object.

        nominal: (rows,) distance at which a row meets the nominal plane.
        """
        bearings = track.bearings[-1] if track.bearings else None  # a track from memory has none yet
        if bearings is None or np.isnan(bearings.bottom) or bearings.camera_x != pose.x:
            return None
        ahead = bearings.camera_z / np.tan(bearings.bottom)
        row = int(np.argmin(np.abs(nominal - ahead)))
        if not 0 < row < len(nominal) - 1 or not plane[row].any():
            return None
        plane_distance = ahead / float(plane[row][plane[row] > 0].mean())
        metres_per_rad = (plane_distance**2 + bearings.camera_z**2) / bearings.camera_z
        pixels = self.settings.pixel_sigma * np.sqrt(self.settings.correlation)
        sigma = metres_per_rad * pixels / self.camera.focal_px
        return NearEdge(pose.x + plane_distance, float(sigma), metres_per_rad)


def _homogeneity_weights(ratio: Array, on_strip: Array) -> Array:
    """Robust weights (rows, columns) of pixels by their deviation from the row's median inside the strip.

    An object is homogeneous over its width; drops on the lens and streaks of rain are not.
    """
    masked = np.where(on_strip, ratio, np.nan)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # rows without pixels inside
        middle = np.nanmedian(masked, axis=1, keepdims=True)
        deviation = np.abs(ratio - middle)
        spread = 1.48 * np.nanmedian(np.where(on_strip, deviation, np.nan), axis=1, keepdims=True)
    return np.nan_to_num(1.0 / (1.0 + (deviation / (_ROBUST * np.maximum(spread, 1e-6))) ** 2))


def _sigma_inflation(samples: HeightRows, bare_rows: Array) -> float:
    """Sigma inflation from the excess scatter of bare-road rows (n,) bool.

    Reflections on a wet road and drops on the lens move independently from frame to frame; a stereo pair sees
    them at the same moment.
    """
    if not bare_rows.any():
        return 1.0
    normal = np.abs(samples.z_m / samples.sigma_m)[bare_rows]
    return max(1.0, _ROW_CORRELATION * 1.48 * float(np.median(normal)))


def _undistortion_maps(camera: Camera) -> tuple[Array, Array]:
    """Undistortion maps (for `cv2.remap`): distorted column and row of each undistorted pixel."""
    v, u = np.mgrid[: camera.height_px, : camera.width_px] + 0.5
    distorted = camera.distort(np.stack([u.ravel(), v.ravel()], axis=1)).astype(np.float32) - np.float32(0.5)
    return distorted[:, 0].reshape(u.shape), distorted[:, 1].reshape(u.shape)


def _strip(track: Track, pose: CameraPose) -> tuple[float, float]:
    """Lateral extent (right, left) over which the object is as it is under a wheel."""
    right = max(track.right.y_m, pose.y - _HALF_STRIP_M)
    left = min(track.left.y_m, pose.y + _HALF_STRIP_M)
    if track.best.kind.sign < 0:
        middle, half = 0.5 * (right + left), 0.25 * (left - right)
        return middle - half, middle + half
    return right, left
