"""Training loop: steps, with validations and checkpoints at intervals."""

import signal
import time
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import torch

from foreride.detector.data.yolo_folder import Sample
from foreride.detector.training.batches import Batch
from foreride.detector.training.history import TrainingLog
from foreride.detector.training.schedule import total_passes
from foreride.detector.training.trainer import Trainer
from foreride.files.progress import Progress


@dataclass(frozen=True)
class LoopSettings:
    """Intervals of checkpoints and validations, and early stopping."""

    checkpoint_s: float = 120.0
    validate_every: int = 8000
    validate_images: int = 200
    patience: int = 0  # validations without a better mAP50-95 after which to stop early; 0 = never


def train(
    trainer: Trainer, feed: Iterable[Batch], validation: Sequence[Sample], out: Path, how: LoopSettings
) -> None:
    """Train on all batches of the feed (or until patience ends), writing checkpoints and the history.

    An interrupt (SIGINT, SIGTERM) writes a checkpoint after the current step, then ends the program.
    """
    total, written, stalled = total_passes(trainer.settings.stages), time.monotonic(), False
    mean, note = torch.zeros(0), ""
    with TrainingLog(out, trainer.passes) as journal, Progress(total, trainer.passes) as progress:
        with _interrupts() as stopped:
            for batch in feed:
                validations_before = trainer.passes // how.validate_every
                terms = trainer.step(batch)  # stays on the device, which else would wait for the host
                mean = mean.lerp(terms, 0.02) if len(mean) else terms
                if journal.step(trainer, terms):
                    note = f"{batch.stage.width}x{batch.stage.height} loss {mean.sum():.3f}"
                progress.show(trainer.passes, note)
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
