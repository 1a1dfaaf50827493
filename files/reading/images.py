"""Reading of image files, with header checks before anything is decoded."""

import io
import warnings
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray
from PIL import (
    BmpImagePlugin,
    Image,
    JpegImagePlugin,
    PngImagePlugin,
    PpmImagePlugin,
    TiffImagePlugin,
    UnidentifiedImageError,
    WebPImagePlugin,
)

from foreride.files.errors import InputError
from foreride.files.reading.regular_file import read_bytes, reading

IMAGE_LIMIT = 256 << 20
"""Maximum size of an image file: 256 MiB."""
MAX_PIXELS = 128_000_000
"""Maximum number of pixels, decoded within seconds and 0.5 GB: 128 megapixels."""
_FORMATS = tuple(
    plugin.format
    for plugin in (
        BmpImagePlugin.BmpImageFile,
        JpegImagePlugin.JpegImageFile,
        PngImagePlugin.PngImageFile,
        PpmImagePlugin.PpmImageFile,
        TiffImagePlugin.TiffImageFile,
        WebPImagePlugin.WebPImageFile,
    )
)
_STILLS_ONLY = frozenset({"PNG", "TIFF", "WEBP"})


def read_pixels(path: Path | str, flags: int) -> NDArray[Any]:
    """Decode one image file with OpenCV and its `flags`: (H, W) or (H, W, channels), blue first.

    Raises InputError for a file that is not a single image, too large, truncated, or cannot be decoded.
    """
    return decode(read_bytes(path, IMAGE_LIMIT), path, flags)


def decode(data: bytes, path: Path | str, flags: int) -> NDArray[Any]:
    """Decode as `read_pixels`, from the content of the file at `path`."""
    if not data:
        raise InputError(f"{path}: empty file; must be an image")
    if _is_cut_short(data):
        raise InputError(f"{path}: the file is truncated")
    _check_header(data, path)
    try:
        image = cv2.imdecode(np.frombuffer(data, np.uint8), flags)
    except (cv2.error, MemoryError):
        image = None
    if image is None:
        raise InputError(f"{path}: cannot be decoded as an image")
    return np.asarray(image)


def _check_header(data: bytes, path: Path | str) -> None:
    with reading(path), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            with Image.open(io.BytesIO(data), formats=_FORMATS) as image:
                (width, height), animated = image.size, image.format in _STILLS_ONLY and _frames(image) > 1
        except (UnidentifiedImageError, SyntaxError, OSError, ValueError):
            raise InputError(f"{path}: cannot be decoded as an image") from None
        except Image.DecompressionBombError:
            raise InputError(f"{path}: must have at most {MAX_PIXELS} pixels") from None
    if width * height > MAX_PIXELS:
        raise InputError(f"{path}: must have at most {MAX_PIXELS} pixels, got {width} x {height}")
    if animated:
        raise InputError(f"{path}: holds several pictures; must be one image")


def _frames(image: Image.Image) -> int:
    return int(getattr(image, "n_frames", 1))


def _is_cut_short(data: bytes) -> bool:
    """Whether the end of a JPEG or PNG is missing: decoders silently fill the rest with grey."""
    if data[:2] == b"\xff\xd8":
        return b"\xff\xd9" not in data[len(data) // 2 :]
    return data[:4] == b"\x89PNG" and not _has_complete_chunks(data)


def _has_complete_chunks(data: bytes) -> bool:
    """Whether a PNG is made of chunks that lie in the file, to the last (ISO 15948, 5.3).

    The decoder allocates what a chunk claims, up to 2 GiB, before it looks for it.
    """
    offset = 8
    while offset + 12 <= len(data):
        size, kind = int.from_bytes(data[offset : offset + 4]), data[offset + 4 : offset + 8]
        offset += size + 12
        if kind == b"IEND":
            return offset <= len(data)
    return False
