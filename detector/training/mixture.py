"""Mixture of image sets: photographs, for instance, at a stated share of the rendered images."""

import math
from collections.abc import Sequence
from typing import overload

import numpy as np

from foreride.detector.data.yolo_folder import Sample
from foreride.files.errors import InputError


class Mixture(Sequence[Sample]):
    """Samples of several sets; an epoch repeats the sets as often as their shares need.

    shares: of all sets but the first, which has the rest. Every sample occurs at least once in an epoch.
    places (n, 2): set and index in it, of each sample of the mixture.
    """

    def __init__(self, sets: Sequence[Sequence[Sample]], shares: Sequence[float] = ()):
        rest = 1.0 - sum(shares)
        if len(shares) != len(sets) - 1 or not all(share > 0 for share in shares) or rest <= 0:
            raise InputError(f"shares of added sets must be > 0 and sum to < 1, got {list(shares)}")
        self.sets = sets
        all_shares = (rest, *shares)
        total = max(len(one) / share for one, share in zip(sets, all_shares, strict=True))
        counts = [
            max(len(one), math.floor(total * share)) for one, share in zip(sets, all_shares, strict=True)
        ]
        self.places = np.concatenate(
            [
                np.stack((np.full(count, number), np.arange(count) % len(one)), axis=1)
                for number, (one, count) in enumerate(zip(sets, counts, strict=True))
            ]
        )

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
