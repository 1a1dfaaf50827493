"""Training log: history.jsonl, TensorBoard events, and images with predictions."""

import json
import math
from collections.abc import Sequence
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np
import torch

from foreride.detector.data.yolo_folder import Sample
from foreride.detector.evaluation.annotated_images import KEY, png, sheet, tile
from foreride.detector.evaluation.plots import read_history
from foreride.detector.training.schedule import Stage
from foreride.detector.training.trainer import TERMS, Trainer, match_whole_image, validate
from foreride.files.errors import InputError
from foreride.files.reading.regular_file import read_text, reading
from foreride.files.reading.strict_json import JSON_LIMIT, parse_json
from foreride.files.writing.atomic import write_bytes, write_text

LOG_INTERVAL_STEPS = 20  # steps between two points of the loss curves
TILES, COLUMNS = 12, 4
SHOWN_CONFIDENCE = 0.25


class TrainingLog:
    """Training log in a run folder, continued at `passes` image passes.

    history.jsonl has one line for each validation, predictions/ one contact sheet of the same few images
    each; tensorboard/ events with the loss terms, the learning rate, and the entries of the history. Entries
    of an earlier run for later passes are dropped, since its checkpoint does not hold them.
    """

    def __init__(self, out: Path, passes: int):
        self.out, self.steps = out, 0
        self.history = out / "history.jsonl"
        if self.history.exists():
            _truncate_history(self.history, passes)
        self.events = _events(out / "tensorboard", passes)

    def __enter__(self) -> "TrainingLog":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self.events:
            self.events.close()

    def step(self, trainer: Trainer, terms: torch.Tensor) -> bool:
        """Log the loss terms of a step, every `LOG_INTERVAL_STEPS` steps; whether this is one of them."""
        self.steps += 1
        is_logged = self.steps % LOG_INTERVAL_STEPS == 1
        if self.events and is_logged:
            for name, value in zip(TERMS, terms.tolist(), strict=False):
                self.events.add_scalar(f"loss/{name}", value, trainer.passes)
            rate = trainer.optimiser.param_groups[0]["lr"]
            self.events.add_scalar("learning rate", rate, trainer.passes)
        return is_logged

    def validation(self, trainer: Trainer, samples: Sequence[Sample], loss: torch.Tensor) -> None:
        """Append the metrics of the model at the image size of the last stage.

        loss: running mean of the terms, of length 0 before the first step
        """
        stage, passes = trainer.settings.stages[-1], trainer.passes
        summary = validate(trainer, samples, stage)
        row = {"passes": passes, "size": f"{stage.width}x{stage.height}"}
        if len(loss):
            row["loss"] = {
                name: value if math.isfinite(value) else None
                for name, value in zip(TERMS, loss.tolist(), strict=False)
            }
        previous_text = read_text(self.history, JSON_LIMIT) if self.history.exists() else ""
        write_text(self.history, f"{previous_text}{json.dumps(row | summary)}\n")
        picture = predictions(trainer, samples, stage)
        write_bytes(self.out / "predictions" / f"{passes:08}.png", png(picture))
        if self.events:
            self._to_events(summary, picture, passes)
        text = f"mAP50 {summary['map50'] or 0:.3f}, mAP50-95 {summary['map50_95'] or 0:.3f}"
        print(f"{passes} passes: {text}", flush=True)

    def _to_events(self, summary: dict, picture: np.ndarray, passes: int) -> None:
        rows = {"mean": summary, **summary["per_class"]}
        for name, row in rows.items():
            for key in ("map50", "map50_95", "ap50", "ap50_95", "precision", "recall"):
                if row.get(key) is not None:
                    self.events.add_scalar(f"validation {name}/{key}", row[key], passes)
        self.events.add_image("predictions", picture, passes, dataformats="HWC")
        self.events.flush()

    def stalled(self, patience: int) -> bool:
        """True if the best mAP50-95 of the history is older than its last `patience` lines."""
        scores = [row["map50_95"] or 0.0 for row in read_history(self.history)]
        return len(scores) > patience and max(scores[:-patience]) >= max(scores[-patience:])


def predictions(trainer: Trainer, samples: Sequence[Sample], stage: Stage) -> np.ndarray:
    """Contact sheet of a few validation images, always the same, with true and detected boxes."""
    deployed = trainer.deployed()
    chosen = np.linspace(0, len(samples) - 1, min(TILES, len(samples))).round().astype(int)
    tiles = []
    for sample in (samples[i] for i in chosen):
        view, result = match_whole_image(trainer, deployed, sample, stage)
        evaluated = view.classes >= 0
        tiles.append(tile(view.image, view.boxes[evaluated], result, SHOWN_CONFIDENCE, sample.name, 360))
    return sheet(tiles, COLUMNS, f"after {trainer.passes} passes, confidence {SHOWN_CONFIDENCE:g}   ({KEY})")


def _truncate_history(history: Path, passes: int) -> None:
    """Drop incomplete history lines, and lines of more than so many passes."""
    kept_lines = []
    for line in read_text(history, JSON_LIMIT).split("\n"):
        try:
            with reading(history):
                if parse_json(line, str(history))["passes"] <= passes:
                    kept_lines.append(line + "\n")
        except InputError:
            continue  # incomplete line, after a full disk or a killed program
    write_text(history, "".join(kept_lines))


def _events(folder: Path, passes: int) -> Any:
    """TensorBoard writer, cleared of events after `passes`; None if the package is not installed."""
    try:
        from torch.utils.tensorboard import SummaryWriter
    except ImportError:
        print("no TensorBoard log: it needs the package tensorboard (extra training)", flush=True)
        return None
    return SummaryWriter(str(folder), purge_step=passes + 1)
