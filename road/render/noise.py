"""Random fields: smooth fractal noise and the periodic grain of asphalt."""

import cv2
import numpy as np

GRAIN_CELLS = 512


def fractal(rng: np.random.Generator, shape: tuple[int, int], amplitudes: tuple[float, ...]) -> np.ndarray:
    """Fractal noise: sum of octaves of smooth noise, float32 of the given shape.

    `amplitudes` runs from the coarsest octave to the finest (one lattice point per cell); each octave
    halves the spacing of its lattice.
    """
    rows, cols = shape
    field = np.zeros((1, 1), np.float32)
    for index, amplitude in enumerate(amplitudes):
        step = 2 ** (len(amplitudes) - 1 - index)
        size = (-(-rows // step) + 1, -(-cols // step) + 1)
        field = _upsample(field, size)
        field = field + np.float32(amplitude) * rng.standard_normal(size, dtype=np.float32)
    return field[:rows, :cols]


def _upsample(field: np.ndarray, size: tuple[int, int]) -> np.ndarray:
    return cv2.resize(field, (size[1], size[0]), interpolation=cv2.INTER_CUBIC)


def grain(rng: np.random.Generator) -> np.ndarray:
    """Periodic asphalt grain (GRAIN_CELLS squared, float32, zero mean, unit variance).

    White noise shaped by a log-normal band around 1/8 cycle per cell (the stones) and one at 1/50 (the
    mixture), clipped asymmetrically so that bright stones stand out more than dark gaps.
    """
    n = GRAIN_CELLS
    spectrum = np.fft.rfft2(rng.standard_normal((n, n)))
    wave = np.hypot(np.fft.fftfreq(n)[:, None], np.fft.rfftfreq(n)[None]) + 1e-6
    stones = np.fft.irfft2(spectrum * np.exp(-((np.log(wave / 0.13) / 0.8) ** 2)), s=(n, n))
    mixture = np.fft.irfft2(spectrum * np.exp(-((np.log(wave / 0.02) / 0.6) ** 2)), s=(n, n))
    field = np.clip(stones / stones.std(), -2.2, 3.5) + 0.4 * mixture / mixture.std()
    return ((field - field.mean()) / field.std()).astype(np.float32)
