"""Image sensor: linear radiance to 8-bit pixels, with rain, bonnet, blur, exposure, noise and tone curve."""

import cv2
import numpy as np
from numpy.typing import NDArray

from foreride.files.jit import njit
from foreride.road.render.appearance import Appearance

_CURVE_TOP = 4.0
_CURVE_STEPS = 4096
POOL_SIZE = 1 << 20
_LEAST_BLUR_PX = 0.2
_BLUR_REACH = 4.0  # standard deviations; OpenCV's kernels for float images end there


def tone_curve() -> np.ndarray:
    """Tone curve (4097,) uint8: linear exposure 0..4 to sRGB-like code with a soft shoulder."""
    linear = np.linspace(0, _CURVE_TOP, _CURVE_STEPS + 1)
    code = (1 - np.exp(-1.5 * linear)) ** (1 / 2.2)
    contrast = 0.6 * code + 0.4 * code * code * (3 - 2 * code)
    return np.rint(255 * np.clip(contrast, 0, 1)).astype(np.uint8)


def tone(exposed: np.ndarray, curve: np.ndarray) -> NDArray[np.uint8]:
    """Code of each linear exposure, without noise."""
    positions = np.clip(exposed * (_CURVE_STEPS / _CURVE_TOP), 0, _CURVE_STEPS)
    return np.asarray(curve[positions.astype(int)])


def fill_rows(image: np.ndarray, colour: np.ndarray) -> None:
    """Fill an image with one colour, by copies of a whole row: much faster than pixel by pixel."""
    image[:] = np.tile(colour.astype(image.dtype), (image.shape[1], 1))


def noise_pool(rng: np.random.Generator) -> np.ndarray:
    """Pool of standard normal numbers, which every frame reads from an offset of its own."""
    return rng.standard_normal(POOL_SIZE, dtype=np.float32)


def bonnet_row(appearance: Appearance, width: int, height: int) -> np.ndarray:
    """(width,) first row of each column that the bonnet hides; `height` where it hides nothing."""
    if appearance.bonnet == 0:
        return np.full(width, height)
    u = (np.arange(width) + 0.5) / width * 2 - 1
    return np.rint(height * (1 - appearance.bonnet * (1 - 0.35 * u**2))).astype(int)


def paint_bonnet(image: np.ndarray, rows: np.ndarray, sheen: np.ndarray) -> None:
    """Paint a dark glossy bonnet below `rows` that reflects a little of the sky (`sheen`, rgb)."""
    top = int(rows.min())
    depth = np.arange(top, image.shape[0])[:, None] - rows[None]
    hidden = depth >= 0
    gloss = 0.04 + 0.12 * np.exp(-depth[hidden] / (0.03 * image.shape[0]))
    image[top:][hidden] = gloss[:, None] * sheen


def rain_streaks(
    image: np.ndarray, rng: np.random.Generator, brightness: np.ndarray, first_row: int = 0
) -> None:
    """Rain streaks: falling drops, blurred by their motion; only in rows from `first_row` on."""
    height, width = image.shape[:2]
    veil = np.zeros((height, width), np.float32)
    for _ in range(int(rng.integers(60, 160))):
        x, y = int(rng.integers(width)), int(rng.integers(-10, height))
        length = int(rng.integers(6, 22))
        cv2.line(
            veil,
            (x, y),
            (x + int(rng.normal(0, 2)), y + length),
            float(rng.uniform(0.06, 0.2)),
            1,
            cv2.LINE_AA,
        )
    rows, cols = np.nonzero(veil[first_row:])
    rows += first_row
    image[rows, cols] += veil[rows, cols, None] * brightness


def develop(
    image: np.ndarray,
    appearance: Appearance,
    exposure: float,
    pool: np.ndarray,
    rng: np.random.Generator,
    curve: np.ndarray,
    first_row: int = 0,
) -> np.ndarray:
    """Sensor model: lens blur, exposure, shot and read noise, tone curve; returns (H, W, 3) uint8.

    Rows above `first_row` stay undefined; of `image`, rows from `first_blurred_row` on are read.
    """
    if appearance.blur_px > _LEAST_BLUR_PX:
        top = first_blurred_row(appearance, first_row)
        blurred = np.empty_like(image)
        cv2.GaussianBlur(image[top:], (0, 0), appearance.blur_px, dst=blurred[top:])
        image = blurred
    gains = exposure * np.array([1 + appearance.warmth, 1.0, 1 - appearance.warmth], np.float32)
    out = np.empty(image.shape, np.uint8)
    rows = slice(first_row, None)
    offset = int(rng.integers(pool.size)) + first_row * image.shape[1]
    _expose(image[rows], gains, np.float32(appearance.noise), pool, offset % pool.size, curve, out[rows])
    return out


def first_blurred_row(appearance: Appearance, first_row: int) -> int:
    """First row that the lens blur of rows from `first_row` on mixes in."""
    if appearance.blur_px <= _LEAST_BLUR_PX:
        return first_row
    return max(first_row - int(np.ceil(_BLUR_REACH * appearance.blur_px)) - 1, 0)


@njit(nogil=True, error_model="numpy")
def _expose(image, gains, noise, pool, offset, curve, out):  # type: ignore[no-untyped-def]
    """Expose `image`: one number of the pool is the noise of a pixel's luminance, three are its colours'."""
    rows, cols, _ = image.shape
    base, last = np.float32(0.1), np.float32(_CURVE_STEPS)
    per_light = np.float32(_CURVE_STEPS / _CURVE_TOP)
    luminance_share, colour_share, zero = np.float32(0.8), np.float32(0.6), np.float32(0)
    for r in range(rows):
        for c in range(cols):
            index = offset + r * cols + c
            luminance = luminance_share * pool[np.uint32(index & (POOL_SIZE - 1))]
            index = 7 * ((index + 1) & (POOL_SIZE - 1))
            for q in range(3):
                value = image[r, c, q] * gains[q]
                sigma = noise * np.sqrt(base + max(value, zero))
                grain = colour_share * pool[np.uint32((index + 331 * q) & (POOL_SIZE - 1))]
                code = (value + sigma * (luminance + grain)) * per_light
                out[r, c, q] = curve[np.uint32(min(max(code, zero), last))]
