"""Random road roughness by ISO 8608 class."""

from dataclasses import dataclass
from functools import lru_cache
from typing import Annotated, NamedTuple

import numpy as np
from annotated_types import Interval
from numpy.typing import ArrayLike, NDArray

from foreride.files.reading.checks import check_choice
from foreride.files.reading.ranges import Checked, Seed

ISO_CLASSES = ("A", "B", "C", "D", "E", "F", "G", "H")
REFERENCE_N0 = 0.1  # cycles/m
WAVINESS = 2.0
MIN_WAVENUMBER, MAX_WAVENUMBER = 0.01, 10.0  # cycles/m; ISO 8608 itself covers 0.011 to 2.83
STEP_M = 0.02
BLOCK_M = 1024.0
TRACKS = 11
PART = 4096  # wavenumbers whose matrices are in memory at once


@dataclass(frozen=True)
class Roughness(Checked):
    """ISO 8608 roughness: class "A" (very good) to "H" (very poor), geometric mean, and the random seed.

    The surface is exact on lines half of `track_m` apart, the middle one at y = 0, and so under the wheels of
    a car of that track; between them it is interpolated, which smooths short waves.
    """

    iso_class: str
    seed: Seed = 0
    track_m: Annotated[float, Interval(ge=0.5, le=4.0), "m"] = 1.5

    def __post_init__(self) -> None:
        super().__post_init__()
        check_choice("iso_class", self.iso_class, ISO_CLASSES)

    @property
    def psd_n0_m3(self) -> float:
        """Displacement PSD at 0.1 cycles/m (m^3): 16e-6 for class A, four times as much for each next."""
        return 16e-6 * 4.0 ** ISO_CLASSES.index(self.iso_class)


def displacement_psd(roughness: Roughness, n: ArrayLike) -> NDArray[np.float64]:
    """One-sided displacement PSD G_d(n) = G_d(n0) (n / n0)^-2 in m^3, n in cycles/m (ISO 8608:2016, 5.1)."""
    return roughness.psd_n0_m3 * (np.asarray(n, float) / REFERENCE_N0) ** -WAVINESS


class RoughSurface(NamedTuple):
    """Realisation of a rough surface, periodic along x.

    heights: (tracks, n) m on lines y_m (tracks,), every STEP_M.
    """

    y_m: NDArray[np.float64]
    heights: NDArray[np.float64]

    def height(self, x: ArrayLike, y: ArrayLike) -> NDArray[np.float64]:
        """Bilinear height (m), broadcast over x and y; constant in y beyond the outermost tracks."""
        count, samples = self.heights.shape
        column = np.asarray(x, float) / STEP_M
        row = np.clip((np.asarray(y, float) - self.y_m[0]) / (self.y_m[1] - self.y_m[0]), 0.0, count - 1.0)
        i = np.floor(column).astype(np.int64)
        j = np.minimum(row.astype(np.int64), count - 2)
        s, t = column - i, row - j
        i0, i1 = i % samples, (i + 1) % samples
        z = self.heights
        right = z[j, i0] + s * (z[j, i1] - z[j, i0])
        left = z[j + 1, i0] + s * (z[j + 1, i1] - z[j + 1, i0])
        return right + t * (left - right)


@lru_cache(maxsize=8)
def rough_surface(roughness: Roughness, length_m: float) -> RoughSurface:
    """Realisation of a rough surface, at least `length_m` long.

    Gaussian spectral lines with the class's PSD, correlated across tracks as on an isotropic surface
    (Kamash and Robson, J. Sound Vib. 57(1), 1978): for waviness 2 the cross spectrum of two lines a distance
    b apart is G_d(n) * u K_1(u), u = 2 pi n b. Then the lines of each third of an octave are scaled together
    to the mean square that the class gives it: every realisation, not only their mean, is of its class.
    Roads of up to BLOCK_M share their realisation, whatever their length; longer ones take a block of twice,
    four times... that length.
    """
    period = BLOCK_M
    while period < length_m:
        period *= 2
    samples = round(period / STEP_M)
    n = np.fft.rfftfreq(samples, STEP_M)
    active = (n >= MIN_WAVENUMBER) & (n <= MAX_WAVENUMBER)
    y = roughness.track_m / 2 * np.arange(-(TRACKS // 2), TRACKS // 2 + 1, dtype=np.float64)
    # A spectral line Z adds a mean square of 2 E|Z|^2 / samples^2 = G / period, and E|line|^2 is 2.
    scale = np.sqrt(displacement_psd(roughness, n[active]) / period / 4) * samples
    lines = _normalise_bands(_correlated_lines(n[active], y, roughness.seed), n[active])
    heights = np.empty((TRACKS, samples))
    spectrum = np.zeros(len(n), complex)
    for track in range(TRACKS):
        spectrum[active] = lines[track] * scale
        heights[track] = np.fft.irfft(spectrum, samples)
    heights.setflags(write=False)
    return RoughSurface(y, heights)


def _correlated_lines(n: NDArray[np.floating], y: NDArray[np.float64], seed: int) -> NDArray[np.complex128]:
    """Spectral lines (tracks, k) of wavenumbers n, E|line|^2 = 2, correlated across tracks."""
    distance, rng = np.abs(y[:, None] - y[None, :]), np.random.default_rng(seed)
    lines = np.empty((len(y), len(n)), complex)
    for first in range(0, len(n), PART):
        part = slice(first, first + PART)
        coherence = isotropic_coherence(2 * np.pi * n[part, None, None] * distance)
        root = np.linalg.cholesky(coherence + 1e-9 * np.eye(len(y)))
        line = rng.normal(size=(*n[part].shape, len(y), 2)) @ np.array([1.0, 1j])
        lines[:, part] = np.einsum("kij,kj->ki", root, line).T
    return lines


def _normalise_bands(lines: NDArray[np.complex128], n: NDArray[np.floating]) -> NDArray[np.complex128]:
    """Spectral lines (tracks, k), E|line|^2 = 2, with mean square exactly 2 in each third of an octave."""
    band = np.floor(3 * np.log2(n / MIN_WAVENUMBER) + 1e-9).astype(np.int64)
    first = np.flatnonzero(np.diff(band, prepend=-1))
    weight = n**-WAVINESS
    power = np.add.reduceat(np.abs(lines) ** 2 * weight, first, axis=1)
    gain = np.sqrt(2 * np.add.reduceat(weight, first) / power)
    return lines * np.repeat(gain, np.diff(first, append=len(n)), axis=1)


def isotropic_coherence(u: ArrayLike) -> NDArray[np.float64]:
    """Coherence u K_1(u) of an isotropic surface, 1 at u = 0.

    K_1(u) = integral_0^inf exp(-u cosh t) cosh t dt, by a table.
    """
    grid = np.concatenate([[0.0], np.geomspace(1e-4, 60.0, 1200)])
    t = np.linspace(0.0, 14.0, 1401)
    weight = np.full(len(t), t[1])
    weight[0] /= 2
    value = grid * (np.exp(-grid[:, None] * np.cosh(t)) * np.cosh(t) @ weight)
    value[0] = 1.0
    return np.interp(np.asarray(u, float), grid, value)
