"""Effects laid over the images that a detector is judged on (arXiv 2508.01339, Fig. 9 c, and litter)."""

import zlib
from collections.abc import Callable

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from detector.litter import litter
from detector.weather import Image, fog, motion_blur, rain, snow

EFFECTS: dict[str, Callable[[Image, float, Generator], Image]] = {
    "rain": rain,
    "snow": snow,
    "fog": fog,
    "motion_blur": motion_blur,
    "litter": litter,
}


def degraded(name: str, image: NDArray[np.uint8], effect: str, strength: float) -> NDArray[np.uint8]:
    """An image under the effect of that name, always the same for the same file name of the image."""
    return EFFECTS[effect](image, strength, np.random.default_rng(zlib.crc32(name.encode())))
