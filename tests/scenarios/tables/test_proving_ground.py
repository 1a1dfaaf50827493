"""Tests of the primary-ride measure."""

import numpy as np
import pytest

from foreride.scenarios.tables.proving_ground import primary_ride


def test_of_a_mixture_only_what_lies_below_4_hz_counts() -> None:
    time = np.arange(5000) / 1000
    slow, fast = 3.0 * np.sin(2 * np.pi * 2.0 * time), 5.0 * np.sin(2 * np.pi * 10.0 * time)
    assert primary_ride(1.0 + slow + fast) == pytest.approx(np.sqrt(1.0 + 3.0**2 / 2), rel=1e-9)
    assert primary_ride(fast) == pytest.approx(0.0, abs=1e-9)
