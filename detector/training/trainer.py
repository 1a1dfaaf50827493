"""Trainer: settings, optimiser step, checkpoints, and validation on whole images."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import torch
from torch import nn

from foreride.detector.data.augment import Augmentation
from foreride.detector.data.crops import TrainingView, whole_view
from foreride.detector.data.yolo_folder import Sample
from foreride.detector.evaluation.average_precision import ImageResult, match_detections, summarise
from foreride.detector.network.auxiliary import ALL_CLASSES, OBSTACLES, obstacles_only
from foreride.detector.network.checkpoint import (
    DEFAULT_MODEL,
    Average,
    check_weights,
    load,
    load_network,
    load_weights,
    save,
)
from foreride.detector.network.deployed import Deployed
from foreride.detector.network.heads import anchor_points
from foreride.detector.network.models import build
from foreride.detector.nms import MIN_CONFIDENCE, NMS_IOU, select
from foreride.detector.training.batches import Batch
from foreride.detector.training.distillation import Distillation, DistillationWeights
from foreride.detector.training.losses import LossWeights, detection_loss
from foreride.detector.training.schedule import Stage, rate_factor
from foreride.files.errors import InputError, shown

TERMS = ("box", "class", "distribution", "edge", "distilled logits", "distilled features")


@dataclass(frozen=True)
class Settings:
    """Training settings: all that determines the result, apart from the images."""

    stages: tuple[Stage, ...]
    model: str = "sbp-yolo"
    batch: int = 16
    rate: float = 2e-3
    weight_decay: float = 0.01
    warmup: int = 2000
    decay: str = "linear"
    clip: float = 10.0
    seed: int = 0
    precision: str = "bf16"
    loss: LossWeights = field(default_factory=LossWeights)
    distillation: DistillationWeights = field(default_factory=DistillationWeights)
    augmentation: Augmentation = field(default_factory=Augmentation)
    auxiliary: bool = False


class Trainer:
    """Model in training, with its average, its optimiser, and the number of image passes."""

    def __init__(
        self, settings: Settings, device: torch.device, init: Path | None = None, teacher: Path | None = None
    ):
        torch.manual_seed(settings.seed)
        self.settings, self.device, self.passes = settings, device, 0
        model = build(settings.model, ALL_CLASSES if settings.auxiliary else OBSTACLES)
        if init:
            load_weights(init, model)
        self.model = model.to(device).to(memory_format=torch.channels_last).train()  # type: ignore[call-overload]
        self.average = Average(self.model)
        trainable = nn.ModuleList([self.model])
        self.distillation = None
        if teacher:
            teacher_network = load_network(teacher)[0].to(device).to(memory_format=torch.channels_last)  # type: ignore[call-overload]
            self.distillation = Distillation(self.model, teacher_network, settings.distillation)
            trainable.append(self.distillation.aligned.to(device))
        self.optimiser = torch.optim.AdamW(_groups(trainable, settings.weight_decay), lr=0.0, fused=True)
        self._grid: dict[Stage, tuple[torch.Tensor, torch.Tensor]] = {}

    def step(self, batch: Batch) -> torch.Tensor:
        """One optimiser step; returns the loss terms: four, and two more with a teacher."""
        settings = self.settings
        factor = rate_factor(settings.stages, self.passes, settings.warmup, settings.decay)
        for group in self.optimiser.param_groups:
            group["lr"] = settings.rate * factor
        images = batch.images.to(self.device, non_blocking=True).float() / 255
        with self.autocast():
            predictions = self.model(images)
        points, stride = self.grid(batch.stage)
        truths = batch.truths.to(self.device)
        terms = detection_loss(predictions, truths, points, stride, settings.loss)
        if self.distillation:
            with self.autocast():
                distillation_terms = self.distillation(images, predictions, truths, points, stride)
            terms = torch.cat((terms, distillation_terms))
        self.optimiser.zero_grad()
        terms.sum().backward()
        nn.utils.clip_grad_norm_(self.model.parameters(), settings.clip)
        self.optimiser.step()
        self.passes = batch.passes + settings.batch
        self.average.update(self.model, self.passes // settings.batch)
        return terms.detach()

    def autocast(self) -> torch.autocast:
        """Autocast context of the training precision."""
        return torch.autocast(self.device.type, torch.bfloat16, enabled=self.settings.precision == "bf16")

    def grid(self, stage: Stage) -> tuple[torch.Tensor, torch.Tensor]:
        """Anchor points and strides of a stage's image size, cached."""
        if stage not in self._grid:
            points, stride = anchor_points(stage.height, stage.width, self.model.strides)
            self._grid[stage] = points.to(self.device), stride.to(self.device)
        return self._grid[stage]

    def deployed(self) -> Deployed:
        """The averaged model as it is deployed, without auxiliary classes."""
        return Deployed(obstacles_only(self.average.model))

    def save(self, path: Path) -> None:
        """Write a checkpoint."""
        content = {
            "model": self.model.state_dict(),
            "average": self.average.model.state_dict(),
            "optimiser": self.optimiser.state_dict(),
            "passes": self.passes,
            "model_name": self.settings.model,
        }
        if self.distillation:
            content["aligned"] = self.distillation.aligned.state_dict()
        save(path, content)

    def restore(self, path: Path) -> None:
        """Restore a checkpoint. Raises InputError if it is of another kind of run."""
        keys = ("model", "average", "optimiser", "passes")
        content = load(path, (*keys, "aligned") if self.distillation else keys)
        for name in ("model", "average"):
            check_weights(content[name], str(path))
        if type(content["passes"]) is not int or content["passes"] < 0:
            raise InputError(f"{path}: passes must be a whole number >= 0, got {shown(content['passes'])}")
        try:
            self.model.load_state_dict(content["model"])
            self.average.model.load_state_dict(content["average"])
            if self.distillation:
                self.distillation.aligned.load_state_dict(content["aligned"])
            self.optimiser.load_state_dict(content["optimiser"])
        except (RuntimeError, ValueError, TypeError, KeyError, AttributeError):
            model_name = content.get("model_name", DEFAULT_MODEL)
            raise InputError(
                f"{path}: the model must be {model_name}, with or without a teacher and auxiliary classes "
                "as in the run that wrote it"
            ) from None
        self.passes = content["passes"]


def _groups(model: nn.Module, weight_decay: float) -> list[dict]:
    """Parameter groups: weight decay for convolution weights only, not for norms and biases."""
    decayed = [p for p in model.parameters() if p.ndim > 1]
    others = [p for p in model.parameters() if p.ndim <= 1]
    return [{"params": decayed, "weight_decay": weight_decay}, {"params": others, "weight_decay": 0.0}]


def validate(trainer: Trainer, samples: Sequence[Sample], stage: Stage, confidence: float = 0.25) -> dict:
    """Metrics of the averaged model on whole images at a stage's size."""
    deployed = trainer.deployed()
    return summarise(
        [match_whole_image(trainer, deployed, sample, stage)[1] for sample in samples], confidence
    )


def match_whole_image(
    trainer: Trainer, deployed: Deployed, sample: Sample, stage: Stage
) -> tuple[TrainingView, ImageResult]:
    """Whole image at a stage's size, and the matched detections of its objects that are not ignored."""
    view = whole_view(sample, stage.width, stage.height)
    with torch.inference_mode(), trainer.autocast():
        boxes, scores = deployed(torch.from_numpy(view.image).to(trainer.device)[None])
    evaluated = view.classes >= 0
    detections = select(boxes[0].float().cpu().numpy(), scores[0].cpu().numpy(), MIN_CONFIDENCE, NMS_IOU)
    return view, match_detections(detections, view.boxes[evaluated], view.classes[evaluated])
