"""Training batches made on the device, as a pure function of (samples, seed, position).

The order of the images is that of `detector.training.batches`; only the random numbers of the views are drawn
on the device.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import torch

from foreride.detector.data.augment import Zoom
from foreride.detector.data.crops import ZOOM
from foreride.detector.data.yolo_folder import Sample
from foreride.detector.training.assigner import GroundTruth
from foreride.detector.training.batches import Batch, epoch_order
from foreride.detector.training.device.light import augmented, restyled
from foreride.detector.training.device.pool import NONE, joined, load_pool
from foreride.detector.training.device.random_numbers import Random
from foreride.detector.training.device.views import Views, random_views
from foreride.detector.training.mixture import Mixture, mixed_places
from foreride.detector.training.schedule import Stage, stage_at, total_passes
from foreride.files.reading.ranges import Checked, Share

STYLE_REACH = (0.004, 0.024)
"""Range of the share of the lowest frequencies that `restyled` takes."""

GROWTH_PASSES = 4096
"""Image passes between two looks for further images."""


@dataclass(frozen=True)
class DeviceAugmentation(Checked):
    """Settings of the views that the device makes.

    zoom: greatest scale, relative to full resolution. style: share of the views of the first set that get the
    lowest frequencies' amplitudes of a view of another set.
    """

    zoom: Zoom = ZOOM
    style: Share = 0.15


class DeviceFeed:
    """Batches of a mixture's images, all of which are kept in the memory of the device.

    arrivals: gives further images of the first set, asked every `GROWTH_PASSES` passes. With it a batch
    depends on when they came, too.
    """

    def __init__(
        self,
        mixture: Mixture,
        device: torch.device,
        seed: int,
        augmentation: DeviceAugmentation,
        arrivals: Callable[[], Sequence[Sample]] = tuple,
    ):
        self.places, self.device, self.seed, self.augmentation = mixture.places, device, seed, augmentation
        self.pools = [load_pool(samples, device) for samples in mixture.sets]
        self.shares, self.arrivals = mixture.shares, arrivals

    def batches(self, stages: tuple[Stage, ...], size: int, start: int) -> Iterator[Batch]:
        """Batches from pass `start` to the end of the last stage."""
        for passes in range(start, total_passes(stages), size):
            if passes // GROWTH_PASSES != (passes - size) // GROWTH_PASSES:
                self._grow()
            yield self.make_batch(stage_at(stages, passes), size, passes)

    @torch.no_grad()
    def make_batch(self, stage: Stage, size: int, passes: int) -> Batch:
        """Batch that starts at image pass number `passes`; every epoch is a fresh permutation."""
        rng = Random(self.device, self.seed, passes)
        places = self.places[[self._index(passes + i) for i in range(size)]]
        parts = []
        for number, pool in enumerate(self.pools):
            index = torch.from_numpy(places[places[:, 0] == number, 1]).to(self.device)
            if len(index):
                parts.append(
                    random_views(pool, index, stage.width, stage.height, self.augmentation.zoom, rng)
                )
        if len(parts) > 1 and self.augmentation.style:
            parts[0] = self._restyled(parts, rng)
        images = augmented(torch.cat([part.images for part in parts]), rng)
        return Batch(images, _truths(parts), stage, passes)

    def _grow(self) -> None:
        samples = self.arrivals()
        if samples:
            self.pools[0] = joined(self.pools[0], load_pool(samples, self.device))
            self.places = mixed_places([len(pool.images) for pool in self.pools], self.shares)

    def _index(self, position: int) -> int:
        epoch, place = divmod(position, len(self.places))
        return int(epoch_order(self.seed, epoch, len(self.places))[place])

    def _restyled(self, parts: list[Views], rng: Random) -> Views:
        """Views of the first set, some of them in the style of views of the others."""
        views, others = parts[0], torch.cat([part.images for part in parts[1:]])
        chosen = rng.chosen(len(views.images), self.augmentation.style).nonzero().squeeze(1)
        if not len(chosen):
            return views
        styles = others[(rng.uniform(len(chosen)) * len(others)).long().clamp(max=len(others) - 1)]
        low, high = STYLE_REACH
        reach = low + (high - low) * float(rng.uniform(1))
        return views._replace(
            images=views.images.index_copy(0, chosen, restyled(views.images[chosen], styles, reach))
        )


def _truths(parts: list[Views]) -> GroundTruth:
    """Objects of the views, as flat arrays."""
    image, classes, boxes, first = [], [], [], 0
    for part in parts:
        number, place = (part.classes != NONE).nonzero(as_tuple=True)
        image.append(number + first)
        classes.append(part.classes[number, place])
        boxes.append(part.boxes[number, place])
        first += len(part.images)
    return GroundTruth(torch.cat(image), torch.cat(classes), torch.cat(boxes))
