"""Views made on the device: what is drawn and what is labelled agree, by the rules of the host's crops."""

import numpy as np
import pytest

pytest.importorskip("torch")
import torch

from foreride.detector.data.crops import IGNORED
from foreride.detector.data.yolo_folder import Sample
from foreride.detector.training.device.pool import NONE, load_pool
from foreride.detector.training.device.random_numbers import Random
from foreride.detector.training.device.views import random_views
from tests.detector.roads import made

CPU = torch.device("cpu")
WIDTH, HEIGHT = 128, 96


def extent(mask: np.ndarray) -> list[float]:
    rows, columns = np.flatnonzero(mask.any(1)), np.flatnonzero(mask.any(0))
    return [columns[0], rows[0], columns[-1] + 1, rows[-1] + 1]


def test_boxes_bound_what_is_drawn() -> None:
    """Bars are white, holes black, on plain grey: their pixels must fill the boxes to a pixel."""
    pool = load_pool([made(seed) for seed in range(6)], CPU)
    views = random_views(pool, torch.arange(60) % 6, WIDTH, HEIGHT, 1.4, Random(CPU, 0))
    seen = {0: 0, 1: 0}
    for image, classes, boxes in zip(*views, strict=True):
        grey = image.mean(0).numpy()
        for cls, mask in ((0, grey > 0.7), (1, grey < 0.2)):
            found = boxes[classes == cls].numpy()
            if len(found):
                seen[cls] += 1
                np.testing.assert_allclose(extent(mask), found[0], atol=1.1)
    assert min(seen.values()) > 15


def test_cut_objects_are_ignored_and_lost_ones_absent() -> None:
    pool = load_pool([made(seed) for seed in range(6)], CPU)
    views = random_views(pool, torch.arange(300) % 6, WIDTH, HEIGHT, 3.0, Random(CPU, 1))
    assert {IGNORED, NONE, 0, 1} == set(views.classes.unique().tolist())
    sides = views.boxes[views.classes >= 0][:, 2:] - views.boxes[views.classes >= 0][:, :2]
    assert sides.min() >= 2.0


def test_zoom_is_reached_and_not_exceeded() -> None:
    sample = made(0)
    pool = load_pool([sample], CPU)
    widths = []
    for seed in range(20):
        views = random_views(pool, torch.zeros(32, dtype=torch.long), WIDTH, HEIGHT, 3.0, Random(CPU, seed))
        heights = (views.boxes[..., 3] - views.boxes[..., 1])[views.classes == 1]
        widths += heights.tolist()
    true_height = float((sample.boxes[1, 3] - sample.boxes[1, 1]) * 192)
    assert 2.5 * true_height < max(widths) <= 3.0 * true_height + 0.01


def test_seeds_decide_the_views() -> None:
    pool = load_pool([made(0)], CPU)
    index = torch.zeros(4, dtype=torch.long)
    one, two, other = (random_views(pool, index, 64, 64, 1.4, Random(CPU, 5, n)) for n in (1, 1, 2))
    assert torch.equal(one.images, two.images)
    assert not torch.equal(one.images, other.images)


def test_images_of_different_sizes_share_a_pool() -> None:
    small = Sample(
        "s.png", np.full((40, 60, 3), 200, np.uint8), np.zeros(0, int), np.zeros((0, 4), np.float32)
    )
    pool = load_pool([made(0), small], CPU)
    assert pool.images.shape == (2, 3, 192, 256)
    views = random_views(pool, torch.ones(8, dtype=torch.long), 60, 40, 1.0, Random(CPU, 0))
    assert (views.classes == NONE).all()
    levels = views.images.flatten(1)
    np.testing.assert_allclose(
        levels.amax(1), 200 / 255, atol=1e-5
    )  # padding only where the window is larger
    np.testing.assert_allclose(levels.median(1).values, 200 / 255, atol=1e-5)
