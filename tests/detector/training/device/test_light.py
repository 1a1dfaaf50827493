"""Photometric augmentation on a device: what each step changes, and what it must leave."""

import numpy as np
import pytest

pytest.importorskip("torch")
import torch

from foreride.detector.training.device.light import augmented, restyled
from foreride.detector.training.device.random_numbers import Random

CPU = torch.device("cpu")


def test_images_vary_and_stay_images() -> None:
    images = torch.full((200, 3, 32, 48), 0.5)
    changed = augmented(images, Random(CPU, 0))
    assert changed.dtype == torch.uint8
    assert changed.is_contiguous(memory_format=torch.channels_last)
    means = changed.float().mean((1, 2, 3))
    assert 90 < means.mean() < 150
    assert means.std() > 10
    assert torch.equal(changed, augmented(images, Random(CPU, 0)))


def test_edges_stay_where_they_are() -> None:
    images = torch.full((40, 3, 32, 48), 0.25)
    images[:, :, 16:] = 0.75
    rows = augmented(images, Random(CPU, 3)).float().mean((1, 3))
    jump = (rows[:, 1:] - rows[:, :-1]).abs()
    assert ((jump.argmax(1) - 15).abs() <= 1).float().mean() > 0.85  # the boundary lies above row 16


def test_style_takes_the_brightness_and_keeps_the_shapes() -> None:
    rng = np.random.default_rng(0)
    images = torch.from_numpy(rng.random((2, 3, 64, 64), dtype=np.float32) * 0.2 + 0.3)
    styles = torch.full((2, 3, 64, 64), 0.6)
    changed = restyled(images, styles, 0.01)
    np.testing.assert_allclose(changed.mean(), 0.6, atol=0.01)
    before, after = (x - x.mean((2, 3), keepdim=True) for x in (images, changed))
    assert torch.nn.functional.cosine_similarity(before.flatten(1), after.flatten(1)).min() > 0.9
    np.testing.assert_allclose(restyled(images, images, 0.02), images, atol=1e-5)
