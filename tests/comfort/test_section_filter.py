"""Tests of the compiled filters against those of SciPy, to the last bit."""

import numpy as np
import pytest
from scipy.signal import lfilter

from foreride.comfort.section_filter import in_parallel, moving_sum

TAPS = np.array([0.9, 0.08, 0.02])
SECTIONS = (
    np.array([[0.05, 0.003, -0.04], [-0.04, -0.02, 0.01]]),
    np.array([[1.0, -1.87, 0.88], [1.0, -1.15, 0.41]]),
)


@pytest.mark.parametrize("shape", [(400,), (2, 400), (3, 2, 400)])
def test_responses_in_two_parts_are_those_of_scipy(shape: tuple[int, ...]) -> None:
    samples = np.random.default_rng(1).normal(size=shape)
    begun, kept = np.zeros((*shape[:-1], 2)), np.zeros((2, *shape[:-1], 2))
    theirs, of_theirs = begun.copy(), list(kept.copy())
    for part in (samples[..., :137], samples[..., 137:]):
        found = moving_sum(TAPS, part, begun)
        summed, theirs = lfilter(TAPS, [1.0], part, zi=theirs)
        np.testing.assert_array_equal(found, summed)
        responses = [lfilter(b, a, summed, zi=zi) for b, a, zi in zip(*SECTIONS, of_theirs, strict=True)]
        of_theirs = [zi for _, zi in responses]
        np.testing.assert_array_equal(in_parallel(SECTIONS, found, kept), sum(out for out, _ in responses))
        np.testing.assert_array_equal(begun, theirs)
        np.testing.assert_array_equal(kept, of_theirs)
