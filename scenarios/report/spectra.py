"""Power spectral density of the body acceleration."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.signal import welch

from foreride.scenarios.definition.clock import TICKS_PER_SECOND
from foreride.scenarios.simulation.simulate import Run

BAND_HZ = (0.4, 80.0)
_SEGMENT = 2048
Array = NDArray[np.float64]


def density(runs: Sequence[Run]) -> tuple[Array, list[Array]]:
    """Frequencies from 0.4 to 80 Hz, and the density (m/s²)²/Hz of `seat_acc_0` of each run (Welch)."""
    length = min(_SEGMENT, *(len(run.signals["seat_acc_0"]) for run in runs))
    densities = []
    for run in runs:
        frequency, values = welch(run.signals["seat_acc_0"], TICKS_PER_SECOND, nperseg=length)
        shown = (frequency >= BAND_HZ[0]) & (frequency <= BAND_HZ[1])
        densities.append(values[shown])
    return frequency[shown], densities
