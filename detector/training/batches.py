"""Training batches as a pure function of (samples, seed, position), prepared ahead by threads.

No state of a random generator is kept between batches, so that a resumed training sees the same batches as an
uninterrupted one.
"""

from collections import deque
from collections.abc import Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from foreride.detector.data.augment import DEFAULT_AUGMENTATION, Augmentation, training_view
from foreride.detector.data.yolo_folder import Sample
from foreride.detector.training.assigner import GroundTruth
from foreride.detector.training.schedule import Stage, stage_at, total_passes


@dataclass(frozen=True)
class Batch:
    """Training batch.

    images (B, 3, H, W) uint8 in channels-last order, truths in its pixels, `passes` completed before it.
    """

    images: Tensor
    truths: GroundTruth
    stage: Stage
    passes: int


@lru_cache(maxsize=4)
def epoch_order(seed: int, epoch: int, count: int) -> NDArray[np.int64]:
    """Order (count,) in which an epoch shows the samples."""
    return np.random.default_rng((seed, epoch)).permutation(count)


def make_batch(
    samples: Sequence[Sample],
    stage: Stage,
    size: int,
    passes: int,
    seed: int,
    augmentation: Augmentation = DEFAULT_AUGMENTATION,
) -> Batch:
    """Batch that starts at image pass number `passes`; every epoch is a fresh permutation."""
    images = np.empty((size, stage.height, stage.width, 3), np.uint8)
    views = []
    for i in range(size):
        epoch, position = divmod(passes + i, len(samples))
        index = epoch_order(seed, epoch, len(samples))[position]
        rng = np.random.default_rng((seed, epoch, position))
        images[i], classes, boxes = training_view(
            samples, index, stage.width, stage.height, rng, augmentation
        )
        views.append((np.full(len(classes), i), classes, boxes))
    image, classes, boxes = (np.concatenate(part) for part in zip(*views, strict=True))
    truths = GroundTruth(torch.from_numpy(image), torch.from_numpy(classes), torch.from_numpy(boxes))
    return Batch(torch.from_numpy(images).permute(0, 3, 1, 2), truths, stage, passes)


def batches(
    samples: Sequence[Sample],
    stages: tuple[Stage, ...],
    size: int,
    start: int,
    seed: int,
    workers: int,
    augmentation: Augmentation = DEFAULT_AUGMENTATION,
) -> Iterator[Batch]:
    """Batches from pass `start` to the end of the last stage, in order, a few prepared ahead."""
    positions = iter(range(start, total_passes(stages), size))
    waiting: deque[Future[Batch]] = deque()
    with ThreadPoolExecutor(workers) as pool:

        def submit() -> None:
            passes = next(positions, None)
            if passes is not None:
                stage = stage_at(stages, passes)
                current_augmentation = augmentation.at(passes / total_passes(stages))
                waiting.append(
                    pool.submit(make_batch, samples, stage, size, passes, seed, current_augmentation)
                )

        for _ in range(2 * workers + 1):
            submit()
        while waiting:
            batch = waiting.popleft().result()
            submit()
            yield batch
