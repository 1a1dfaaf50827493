"""Mixtures: the shares hold in an epoch, and no image is left out."""

import numpy as np
import pytest

from foreride.detector.training.mixture import Mixture
from foreride.files.errors import InputError
from tests.detector.roads import made

SAMPLE = made(0)


@pytest.mark.parametrize(
    ("counts", "shares"), [((100, 7), (0.2,)), ((10, 60), (0.25,)), ((50, 5, 9), (0.1, 0.3))]
)
def test_shares_hold_and_every_sample_occurs(counts: tuple[int, ...], shares: tuple[float, ...]) -> None:
    mixture = Mixture([[SAMPLE] * count for count in counts], shares)
    occurrences = [mixture.places[mixture.places[:, 0] == number, 1] for number in range(len(counts))]
    for found, count, share in zip(occurrences, counts, (1 - sum(shares), *shares), strict=True):
        assert len(found) / len(mixture) == pytest.approx(share, abs=0.03)
        times = np.bincount(found, minlength=count)
        assert times.min() >= 1
        assert times.max() - times.min() <= 1


def test_one_set_stays_as_it_is() -> None:
    samples = [made(seed) for seed in range(3)]
    mixture = Mixture([samples])
    assert [mixture[i] for i in range(3)] == samples == mixture[:]


@pytest.mark.parametrize("shares", [(1.0,), (0.0,), (-0.1,), (float("nan"),), (0.5, 0.5), ()])
def test_shares_that_leave_nothing_are_refused(shares: tuple[float, ...]) -> None:
    with pytest.raises(InputError, match="shares of added sets"):
        Mixture([[SAMPLE]] * (len(shares) + (len(shares) > 0) + 2 * (not shares)), shares)
