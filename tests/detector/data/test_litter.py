"""Litter augmentation: positions, sizes and brightness."""

import numpy as np
import pytest

from foreride.detector.data.litter import TOP_ROW, litter

ROAD = np.full((192, 320, 3), 110, np.uint8)


def changed(image: np.ndarray, strength: float, seed: int) -> np.ndarray:
    """(H, W) bool: pixels of pieces and their shadows."""
    return (litter(image, strength, np.random.default_rng(seed)) != image).any(2)


@pytest.mark.parametrize("seed", range(5))
def test_pieces_lie_low_and_leave_most_of_the_road_alone(seed: int) -> None:
    where = changed(ROAD, 1.0, seed)
    assert where.any()
    assert where.mean() < 0.12
    assert not where[: int(TOP_ROW * 192) - 4].any()


def test_near_pieces_are_larger() -> None:
    shares = np.mean([changed(ROAD, 0.5, seed).mean(1) for seed in range(30)], 0)
    assert shares[150:185].mean() > 2 * shares[70:105].mean() > 0


def test_more_pieces_with_strength() -> None:
    covered = [np.mean([changed(ROAD, s, seed).mean() for seed in range(10)]) for s in (0.0, 0.3, 1.0)]
    assert 0 < covered[0] < covered[1] < covered[2]


def test_pieces_are_darker_at_night() -> None:
    night = np.full_like(ROAD, 12)
    lightest = [
        max(int(litter(road, 1.0, np.random.default_rng(seed)).max()) for seed in range(10))
        for road in (ROAD, night)
    ]
    assert lightest[0] > 1.5 * lightest[1]
