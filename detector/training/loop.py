"""Training loop: steps, with validations and checkpoints at intervals."""

import signal
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import torch

from foreride.detector.data.yolo_folder import Sample
from foreride.detector.training.batches import batches
from foreride.detector.training.history import TrainingLog
from foreride.detector.training.schedule import total_passes
from foreride.detector.training.trainer import Trainer
from foreride.files.progress import Progress


@dataclass(frozen=True)
class LoopSettings:
    """Intervals of checkpoints and validations, early stopping, and loader threads."""

    checkpoint_s: float = 120.0
    validate_every: int = 8000
    validate_images: int = 200
    workers: int = 1
    patience: int = 0  # validations without a better mAP50-95 after which to stop early; 0 = never


def train(
    trainer: Trainer, training: Sequence[Sample], validation: Sequence[Sample], out: Path, how: LoopSettings
) -> None:
    """Train to the end of the last stage (or of patience), writing checkpoints and the history on the way.

    An interrupt (SIGINT, SIGTERM) writes a checkpoint after the current step, then ends the program.
    """
    settings, total = trainer.settings, total_passes(trainer.settings.stages)
    order = (settings.stages, settings.batch, trainer.passes, settings.seed, how.workers)
    feed = batches(training, *order, settings.augmentation)
    mean, written, stalled = torch.zeros(0), time.monotonic(), False
    with TrainingLog(out, trainer.passes) as journal, Progress(total, trainer.passes) as progress:
        with _interrupts() as stopped:
            for batch in feed:
                validations_before = trainer.passes // how.validate_every
                terms = trainer.step(batch).cpu()
                mean = mean.lerp(terms, 0.02) if mean.any() else terms
                journal.step(trainer, terms)
                progress.show(
                    trainer.passes, f"{batch.stage.width}x{batch.stage.height} loss {mean.sum():.3f}"
                )
                if validation and validations_before < trainer.passes // how.validate_every:
                    journal.validation(trainer, validation[: how.validate_images], mean)
                    stalled = how.patience > 0 and journal.stalled(how.patience)
                if stopped or time.monotonic() - written > how.checkpoint_s:
                    trainer.save(out / "checkpoint.pt")
                    written = time.monotonic()
                if stopped:
                    raise SystemExit(f"stopped after {trainer.passes} passes; continue with --resume")
                if stalled:
                    print(f"no better mAP50-95 in {how.patience} validations: stopping early", flush=True)
                    break
        trainer.save(out / "checkpoint.pt")
        if validation:
            journal.validation(trainer, validation, mean)


@contextmanager
def _interrupts() -> Iterator[list[int]]:
    """Collect SIGINT and SIGTERM in a list instead of ending the program."""
    stopped: list[int] = []
    signals = (signal.SIGINT, signal.SIGTERM)
    previous_handlers = [
        signal.signal(signal_number, lambda number, _: stopped.append(number)) for signal_number in signals
    ]
    try:
        yield stopped
    finally:
        for signal_number, handler in zip(signals, previous_handlers, strict=True):
            signal.signal(signal_number, handler)
