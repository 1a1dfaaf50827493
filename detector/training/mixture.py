"""Mixture of image sets: photographs, for instance, at a stated share of the rendered images."""

import math
from collections.abc import Sequence
from typing import overload

import numpy as np
from numpy.typing import NDArray

from foreride.detector.data.yolo_folder import Sample
from foreride.files.errors import InputError


class Mixture(Sequence[Sample]):
    """Samples of several sets; an epoch repeats the sets as often as their shares need.

    shares: of all sets but the first, which has the rest. Every sample occurs at least once in an epoch.
    places (n, 2): set and index in it, of each sample of the mixture.
    """

    def __init__(self, sets: Sequence[Sequence[Sample]], shares: Sequence[float] = ()):
        if len(shares) != len(sets) - 1 or not all(share > 0 for share in shares) or sum(shares) >= 1:
            raise InputError(f"shares of added sets must be > 0 and sum to < 1, got {list(shares)}")
        self.sets, self.shares = sets, tuple(shares)
        self.places = mixed_places([len(one) for one in sets], shares)

    def __len__(self) -> int:
        return len(self.places)

    @overload
    def __getitem__(self, index: int) -> Sample: ...
    @overload
    def __getitem__(self, index: slice) -> "list[Sample]": ...
    def __getitem__(self, index: int | slice) -> "Sample | list[Sample]":
        if isinstance(index, slice):
            return [self[i] for i in range(*index.indices(len(self)))]
        number, place = self.places[index]
        return self.sets[number][int(place)]


def mixed_places(sizes: Sequence[int], shares: Sequence[float]) -> NDArray[np.int64]:
    """Set and index in it (n, 2) of each sample of a `Mixture` of sets of these sizes."""
    all_shares = (1.0 - sum(shares), *shares)
    total = max(size / share for size, share in zip(sizes, all_shares, strict=True))
    counts = [max(size, math.floor(total * share)) for size, share in zip(sizes, all_shares, strict=True)]
    return np.concatenate(
        [
            np.stack((np.full(count, number), np.arange(count) % size), axis=1)
            for number, (size, count) in enumerate(zip(sizes, counts, strict=True))
        ]
    )
