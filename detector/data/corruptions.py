"""Image degradation for evaluation: weather, motion blur and litter (arXiv 2508.01339, Fig. 9 c)."""

import zlib
from collections.abc import Callable

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from foreride.detector.data.litter import litter
from foreride.detector.data.weather import Image, fog, motion_blur, rain, snow

EFFECTS: dict[str, Callable[[Image, float, Generator], Image]] = {
    "rain": rain,
    "snow": snow,
    "fog": fog,
    "motion_blur": motion_blur,
    "litter": litter,
}


def degraded(name: str, image: NDArray[np.uint8], effect: str, strength: float) -> NDArray[np.uint8]:
    """Image with an effect, with random numbers that depend on its file name only."""
    return EFFECTS[effect](image, strength, np.random.default_rng(zlib.crc32(name.encode())))
