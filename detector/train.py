"""Train SBP-YOLO on a folder of labelled images: `foreride detector train --data DIR --out RUN`.

DIR holds train/ and val/, each with images/ and labels/. RUN receives config.json, checkpoint.pt (resume
with `--resume`), history.jsonl (validation after every so many passes) and, at the end, curves.png and
weights.pt.
The same command runs on a CPU and on a GPU.
"""

import argparse
import json
import signal
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import torch

from detector.checkpoint import save_weights
from detector.curves import write_curves
from detector.dataset import Sample, dataset_hash, read_samples
from detector.detection import CLASS_NAMES
from detector.distillation import DistillationWeights
from detector.loader import batches
from detector.losses import LossWeights
from detector.models import MODELS
from detector.progress import Progress
from detector.schedule import parse_stages, total_passes
from detector.trainer import TERMS, Settings, Trainer, validate
from files.atomic import write_text
from files.errors import InputError


@dataclass(frozen=True)
class Routine:
    """When to write, when to look, and how many threads prepare batches."""

    checkpoint_s: float = 120.0
    validate_every: int = 8000
    validate_images: int = 200
    workers: int = 1
    patience: int = 0  # validations without a better mAP50-95 after which to stop early; 0 = never


def train(
    trainer: Trainer, training: Sequence[Sample], validation: Sequence[Sample], out: Path, how: Routine
) -> None:
    """Run to the end of the last stage (or of patience), writing checkpoints and the history on the way.

    An interrupt (SIGINT, SIGTERM) writes a checkpoint after the step under way, then ends the program.
    """
    settings, written, stopped = trainer.settings, time.monotonic(), []
    signal.signal(signal.SIGTERM, lambda *_: stopped.append(True))
    signal.signal(signal.SIGINT, lambda *_: stopped.append(True))
    mean = torch.zeros(1)
    feed = batches(training, settings.stages, settings.batch, trainer.passes, settings.seed, how.workers)
    with Progress(total_passes(settings.stages), trainer.passes) as progress:
        for batch in feed:
            before = trainer.passes
            terms = trainer.step(batch).cpu()
            mean = mean.lerp(terms, 0.02) if mean.any() else terms
            progress.show(trainer.passes, f"{batch.stage.width}x{batch.stage.height} loss {mean.sum():.3f}")
            if before // how.validate_every < trainer.passes // how.validate_every and validation:
                _look(trainer, validation[: how.validate_images], mean, out)
                if how.patience and _stalled(out, how.patience):
                    print(f"no better mAP50-95 in {how.patience} validations: stopping early", flush=True)
                    break
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
    losses = dict(zip(TERMS, loss.tolist(), strict=False))
    row = {"passes": trainer.passes, "size": f"{stage.width}x{stage.height}", "loss": losses, **summary}
    with (out / "history.jsonl").open("a") as history:
        history.write(json.dumps(row) + "\n")
    print(
        f"{trainer.passes} passes: mAP50 {summary['map50']:.3f}, mAP50-95 {summary['map50_95']:.3f}",
        flush=True,
    )


def _stalled(out: Path, patience: int) -> bool:
    """Whether the best mAP50-95 of the history is older than its last `patience` lines."""
    rows = [json.loads(line) for line in (out / "history.jsonl").read_text().splitlines()]
    found = [row["map50_95"] or 0.0 for row in rows]
    return len(found) > patience and max(found[:-patience]) >= max(found[-patience:])


def parser() -> argparse.ArgumentParser:
    p = argparse.ArgumentParser(prog="foreride detector train", description=__doc__)
    p.add_argument("--data", type=Path, required=True, help="folder with train/ and val/")
    p.add_argument("--out", type=Path, required=True, help="folder for checkpoint, history and weights")
    p.add_argument("--stages", default="320x192:60000,640x384:15000", help="WIDTHxHEIGHT:PASSES[,...]")
    p.add_argument("--skip-bad", action="store_true", help="leave out files that cannot be used")
    p.add_argument("--model", choices=MODELS, default="sbp-yolo", help="what to train")
    p.add_argument("--batch", type=int, default=16)
    p.add_argument("--rate", type=float, default=2e-3, help="peak learning rate of AdamW")
    p.add_argument("--nwd-alpha", type=float, default=1.0, help="share of CIoU in the box loss; 1 = no NWD")
    p.add_argument("--nwd-scale", type=float, default=12.8, help="the constant C of the NWD, in strides")
    p.add_argument("--edge-weight", type=float, default=0.0, help="of top and bottom edge's error in strides")
    p.add_argument("--teacher", type=Path, help="weights file of a larger model to learn from (BCKD and CWD)")
    p.add_argument("--distil-logits", type=float, default=0.5, help="weight of BCKD; 0 = none")
    p.add_argument("--distil-features", type=float, default=0.5, help="weight of CWD; 0 = none")
    p.add_argument("--seed", type=int, default=0)
    p.add_argument("--init", type=Path, help="weights file to start from")
    p.add_argument("--resume", action="store_true", help="go on from the checkpoint in --out")
    p.add_argument("--device", default="auto", help="auto, cpu or cuda")
    p.add_argument("--precision", choices=("bf16", "fp32"), default="bf16")
    p.add_argument("--threads", type=int, default=2, help="threads of torch on a CPU")
    p.add_argument("--workers", type=int, default=1, help="threads that prepare batches")
    p.add_argument(
        "--patience", type=int, default=0, help="stop after so many validations that are no better"
    )
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


def _loss_weights(args: argparse.Namespace) -> LossWeights:
    try:
        return LossWeights(nwd_alpha=args.nwd_alpha, nwd_scale=args.nwd_scale, edge=args.edge_weight)
    except ValueError as error:
        raise InputError(str(error)) from None


def run(args: argparse.Namespace) -> None:
    """Train as the command line says. Raises InputError."""
    settings = Settings(
        parse_stages(args.stages),
        args.model,
        args.batch,
        args.rate,
        seed=args.seed,
        precision=args.precision,
        loss=_loss_weights(args),
        distillation=DistillationWeights(args.distil_logits, args.distil_features),
    )
    chosen = args.device if args.device != "auto" else "cuda" if torch.cuda.is_available() else "cpu"
    torch.set_num_threads(args.threads)
    longest = max(max(stage.width, stage.height) for stage in settings.stages)
    training = list(read_samples(args.data / "train", max(longest, 640), args.skip_bad))
    validation = list(read_samples(args.data / "val", max(longest, 640), args.skip_bad))
    trainer = Trainer(settings, torch.device(chosen), args.init, args.teacher)
    args.out.mkdir(parents=True, exist_ok=True)
    checkpoint = args.out / "checkpoint.pt"
    if args.resume:
        trainer.restore(checkpoint)
    elif checkpoint.exists():
        raise InputError(f"{checkpoint}: already there; add --resume to go on or choose another --out")
    config = {"settings": asdict(settings)} | {k: str(v) for k, v in vars(args).items()}
    write_text(args.out / "config.json", json.dumps(config, indent=1) + "\n")
    print(
        f"{len(training)} training, {len(validation)} validation images; {args.stages} on {chosen}",
        flush=True,
    )
    how = Routine(workers=args.workers, validate_every=args.validate_every, patience=args.patience)
    train(trainer, training, validation, args.out, how)
    write_curves(args.out)
    metadata = {
        "model": settings.model,
        "names": list(CLASS_NAMES),
        "passes": trainer.passes,
        "stages": args.stages,
        "dataset": dataset_hash(args.data / "train"),
        "settings": json.dumps(asdict(settings)),
    }
    save_weights(args.out / "weights.pt", trainer.average.model, metadata)


if __name__ == "__main__":
    raise SystemExit(main())
