"""Train SBP-YOLO on a folder of labelled images: `python -m detector.train --data DIR --out RUN`.

DIR holds train/ and val/, each with images/ and labels/. RUN receives checkpoint.pt (resume with
`--resume`), history.jsonl (validation after every so many passes) and, at the end, weights.pt.
The same command runs on a CPU and on a GPU.
"""

import argparse
import json
import signal
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path

import numpy as np
import torch
from torch import nn

from detector.augment import whole_view
from detector.checkpoint import Average, load, load_weights, save, save_weights
from detector.dataset import Sample, dataset_hash, read_samples
from detector.deploy import Deployed
from detector.heads import anchor_points
from detector.loader import Batch, batches
from detector.losses import LossWeights, detection_loss
from detector.metrics import judge, summarise
from detector.models import STRIDES, SbpYolo
from detector.nms import select
from detector.progress import Progress
from detector.schedule import Stage, parse_stages, rate_factor, total_passes
from files.errors import InputError


@dataclass(frozen=True)
class Settings:
    """What decides the result of a training, apart from the images."""

    stages: tuple[Stage, ...]
    batch: int = 16
    rate: float = 2e-3
    weight_decay: float = 0.01
    warmup: int = 2000
    clip: float = 10.0
    seed: int = 0
    precision: str = "bf16"
    loss: LossWeights = field(default_factory=LossWeights)


class Trainer:
    """A model in training, its average, its optimiser, and how many image passes they have seen."""

    def __init__(self, settings: Settings, device: torch.device, init: Path | None = None):
        torch.manual_seed(settings.seed)
        self.settings, self.device, self.passes = settings, device, 0
        model = SbpYolo()
        if init:
            load_weights(init, model)
        self.model = model.to(device).to(memory_format=torch.channels_last).train()  # type: ignore[call-overload]
        self.average = Average(self.model)
        self.optimiser = torch.optim.AdamW(_groups(self.model, settings.weight_decay), lr=0.0, fused=True)
        self._grid: dict[Stage, tuple[torch.Tensor, torch.Tensor]] = {}

    def step(self, batch: Batch) -> torch.Tensor:
        """One update; gives the three loss terms."""
        settings = self.settings
        factor = rate_factor(settings.stages, self.passes, settings.warmup)
        for group in self.optimiser.param_groups:
            group["lr"] = settings.rate * factor
        images = batch.images.to(self.device, non_blocking=True).float() / 255
        with self.autocast():
            predictions = self.model(images)
        points, stride = self.grid(batch.stage)
        terms = detection_loss(predictions, batch.truths.to(self.device), points, stride, settings.loss)
        self.optimiser.zero_grad()
        terms.sum().backward()
        nn.utils.clip_grad_norm_(self.model.parameters(), settings.clip)
        self.optimiser.step()
        self.passes = batch.passes + settings.batch
        self.average.update(self.model, self.passes // settings.batch)
        return terms.detach()

    def autocast(self) -> torch.autocast:
        return torch.autocast(self.device.type, torch.bfloat16, enabled=self.settings.precision == "bf16")

    def grid(self, stage: Stage) -> tuple[torch.Tensor, torch.Tensor]:
        if stage not in self._grid:
            points, stride = anchor_points(stage.height, stage.width, STRIDES)
            self._grid[stage] = points.to(self.device), stride.to(self.device)
        return self._grid[stage]

    def save(self, path: Path) -> None:
        save(
            path,
            {
                "model": self.model.state_dict(),
                "average": self.average.model.state_dict(),
                "optimiser": self.optimiser.state_dict(),
                "passes": self.passes,
            },
        )

    def restore(self, path: Path) -> None:
        content = load(path, ("model", "average", "optimiser", "passes"))
        self.model.load_state_dict(content["model"])
        self.average.model.load_state_dict(content["average"])
        self.optimiser.load_state_dict(content["optimiser"])
        self.passes = content["passes"]


def _groups(model: nn.Module, weight_decay: float) -> list[dict]:
    """Decay for convolution weights only, not for norms and biases."""
    decayed = [p for p in model.parameters() if p.ndim > 1]
    others = [p for p in model.parameters() if p.ndim <= 1]
    return [{"params": decayed, "weight_decay": weight_decay}, {"params": others, "weight_decay": 0.0}]


def validate(trainer: Trainer, samples: Sequence[Sample], stage: Stage, confidence: float = 0.25) -> dict:
    """Metrics of the averaged model on whole images at a stage's size."""
    deployed = Deployed(trainer.average.model)
    results = []
    for start in range(0, len(samples), trainer.settings.batch):
        views = [
            whole_view(s, stage.width, stage.height) for s in samples[start : start + trainer.settings.batch]
        ]
        images = torch.from_numpy(np.stack([image for image, _, _ in views])).to(trainer.device)
        with torch.inference_mode(), trainer.autocast():
            boxes, scores = deployed(images)
        for b, s, (_, classes, truth) in zip(boxes.cpu().numpy(), scores.cpu().numpy(), views, strict=True):
            asked = classes >= 0
            results.append(judge(select(b, s, 0.001, 0.5), truth[asked], classes[asked]))
    return summarise(results, confidence)


@dataclass(frozen=True)
class Routine:
    """When to write, when to look, and how many threads prepare batches."""

    checkpoint_s: float = 120.0
    validate_every: int = 8000
    validate_images: int = 200
    workers: int = 1


def train(
    trainer: Trainer, training: Sequence[Sample], validation: Sequence[Sample], out: Path, how: Routine
) -> None:
    """Run to the end of the last stage, writing checkpoints and the history on the way.

    An interrupt (SIGINT, SIGTERM) writes a checkpoint after the step under way, then ends the program.
    """
    settings, written, stopped = trainer.settings, time.monotonic(), []
    signal.signal(signal.SIGTERM, lambda *_: stopped.append(True))
    signal.signal(signal.SIGINT, lambda *_: stopped.append(True))
    mean = torch.zeros(3)
    feed = batches(training, settings.stages, settings.batch, trainer.passes, settings.seed, how.workers)
    with Progress(total_passes(settings.stages), trainer.passes) as progress:
        for batch in feed:
            before = trainer.passes
            mean = mean.lerp(trainer.step(batch).cpu(), 0.02 if mean.any() else 1.0)
            progress.show(trainer.passes, f"{batch.stage.width}x{batch.stage.height} loss {mean.sum():.3f}")
            if before // how.validate_every < trainer.passes // how.validate_every and validation:
                _look(trainer, validation[: how.validate_images], mean, out)
            if stopped or time.monotonic() - written > how.checkpoint_s:
                trainer.save(out / "checkpoint.pt")
                written = time.monotonic()
            if stopped:
                raise SystemExit(f"stopped after {trainer.passes} passes; go on with --resume")
    trainer.save(out / "checkpoint.pt")
    if validation:
        _look(trainer, validation, mean, out)


def _look(trainer: Trainer, samples: Sequence[Sample], loss: torch.Tensor, out: Path) -> None:
    """Append one line to the history: how the model does at the size of the last stage."""
    stage = trainer.settings.stages[-1]
    summary = validate(trainer, samples, stage)
    losses = dict(zip(("box", "class", "distribution"), loss.tolist(), strict=True))
    row = {"passes": trainer.passes, "size": f"{stage.width}x{stage.height}", "loss": losses, **summary}
    with (out / "history.jsonl").open("a") as history:
        history.write(json.dumps(row) + "\n")
    print(
        f"{trainer.passes} passes: mAP50 {summary['map50']:.3f}, mAP50-95 {summary['map50_95']:.3f}",
        flush=True,
    )


def parser() -> argparse.ArgumentParser:
    p = argparse.ArgumentParser(prog="python -m detector.train", description=__doc__)
    p.add_argument("--data", type=Path, required=True, help="folder with train/ and val/")
    p.add_argument("--out", type=Path, required=True, help="folder for checkpoint, history and weights")
    p.add_argument("--stages", default="320x192:60000,640x384:15000", help="WIDTHxHEIGHT:PASSES[,...]")
    p.add_argument("--batch", type=int, default=16)
    p.add_argument("--rate", type=float, default=2e-3, help="peak learning rate of AdamW")
    p.add_argument("--nwd-alpha", type=float, default=1.0, help="share of CIoU in the box loss; 1 = no NWD")
    p.add_argument("--nwd-scale", type=float, default=12.8, help="the constant C of the NWD, in strides")
    p.add_argument("--seed", type=int, default=0)
    p.add_argument("--init", type=Path, help="weights file to start from")
    p.add_argument("--resume", action="store_true", help="go on from the checkpoint in --out")
    p.add_argument("--device", default="auto", help="auto, cpu or cuda")
    p.add_argument("--precision", choices=("bf16", "fp32"), default="bf16")
    p.add_argument("--threads", type=int, default=2, help="threads of torch on a CPU")
    p.add_argument("--workers", type=int, default=1, help="threads that prepare batches")
    p.add_argument("--validate-every", type=int, default=8000, help="passes between two validations")
    return p


def main(arguments: Sequence[str] | None = None) -> int:
    args = parser().parse_args(arguments)
    try:
        run(args)
    except InputError as error:
        print(f"error: {error}")
        return 2
    return 0


def run(args: argparse.Namespace) -> None:
    """Train as the command line says. Raises InputError."""
    loss = LossWeights(nwd_alpha=args.nwd_alpha, nwd_scale=args.nwd_scale)
    settings = Settings(
        parse_stages(args.stages), args.batch, args.rate, seed=args.seed, precision=args.precision, loss=loss
    )
    chosen = args.device if args.device != "auto" else "cuda" if torch.cuda.is_available() else "cpu"
    torch.set_num_threads(args.threads)
    longest = max(max(stage.width, stage.height) for stage in settings.stages)
    training = list(read_samples(args.data / "train", max(longest, 640)))
    validation = list(read_samples(args.data / "val", max(longest, 640)))
    trainer = Trainer(settings, torch.device(chosen), args.init)
    args.out.mkdir(parents=True, exist_ok=True)
    checkpoint = args.out / "checkpoint.pt"
    if args.resume:
        trainer.restore(checkpoint)
    elif checkpoint.exists():
        raise InputError(f"{checkpoint}: already there; add --resume to go on or choose another --out")
    print(
        f"{len(training)} training, {len(validation)} validation images; {args.stages} on {chosen}",
        flush=True,
    )
    train(
        trainer,
        training,
        validation,
        args.out,
        Routine(workers=args.workers, validate_every=args.validate_every),
    )
    metadata = {
        "passes": trainer.passes,
        "stages": args.stages,
        "dataset": dataset_hash(args.data / "train"),
        "settings": json.dumps(asdict(settings)),
    }
    save_weights(args.out / "weights.pt", trainer.average.model, metadata)


if __name__ == "__main__":
    raise SystemExit(main())
