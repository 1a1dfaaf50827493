"""Image file reader that refuses files that do not match their labels without a warning."""

import io
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray
from PIL import ExifTags, Image

from foreride.files.errors import InputError
from foreride.files.reading.images import IMAGE_LIMIT, decode
from foreride.files.reading.regular_file import read_bytes

_UPRIGHT = 1


def read_image(path: Path) -> NDArray[np.uint8]:
    """RGB image (H, W, 3) uint8 of a colour file with 8 bits per channel.

    Raises InputError naming a file that is empty, no image, truncated, grey, of more than 8 bits, or rotated
    by its EXIF orientation, which labelling programs may or may not have applied.
    """
    data = read_bytes(path, IMAGE_LIMIT)
    image = decode(data, path, cv2.IMREAD_UNCHANGED)
    if image.dtype != np.uint8:
        raise InputError(f"{path}: {image.dtype.itemsize * 8} bits per channel; must be 8")
    if image.ndim != 3 or _is_grey_png(data):
        raise InputError(f"{path}: a grey image; must have three colours")
    orientation = exif_orientation(data)
    if orientation != _UPRIGHT:
        raise InputError(
            f"{path}: EXIF orientation {orientation}; save it upright (orientation 1), labels accordingly"
        )
    code = cv2.COLOR_BGRA2RGB if image.shape[2] == 4 else cv2.COLOR_BGR2RGB
    return cv2.cvtColor(image, code).astype(np.uint8, copy=False)


def exif_orientation(data: bytes) -> int:
    """EXIF orientation 1..8 of an image file; 1 if absent (EXIF 2.32, 4.6)."""
    try:
        with Image.open(io.BytesIO(data)) as image:
            orientation = int(image.getexif().get(ExifTags.Base.Orientation, _UPRIGHT))
    except Exception:  # a broken EXIF block counts as absent; the image itself was checked before
        return _UPRIGHT
    return orientation if orientation in range(1, 9) else _UPRIGHT


def _is_grey_png(data: bytes) -> bool:
    """True for a grey PNG, with or without alpha, which OpenCV reads as colour (ISO 15948, 11.2.2)."""
    return data[:4] == b"\x89PNG" and data[25:26] in (b"\0", b"\4")
