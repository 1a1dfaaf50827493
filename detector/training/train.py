"""Training of SBP-YOLO on a folder of labelled images: `foreride detector train --data DIR --out RUN`.

DIR holds train/ and val/, each with images/ and labels/. RUN receives config.json, checkpoint.pt (resume with
`--resume`), history.jsonl (periodic validations), predictions/ (detections in a few images, at each
validation), tensorboard/ (`tensorboard --logdir RUN`) and, at the end, curves.png and weights.pt. The same
command runs on a CPU and on a GPU.
"""

import argparse
import json
import math
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

import torch

from foreride.detector.data.augment import Augmentation
from foreride.detector.data.yolo_folder import dataset_hash
from foreride.detector.detections import CLASS_NAMES
from foreride.detector.evaluation.plots import write_curves
from foreride.detector.network.checkpoint import save_weights
from foreride.detector.network.models import MODELS
from foreride.detector.training.distillation import DistillationWeights
from foreride.detector.training.image_store import load_cached_dataset
from foreride.detector.training.loop import LoopSettings, train
from foreride.detector.training.losses import LossWeights
from foreride.detector.training.schedule import DECAYS, parse_stages
from foreride.detector.training.trainer import Settings, Trainer
from foreride.files.command_line import Parser, notify
from foreride.files.errors import InputError
from foreride.files.writing.atomic import write_text
from foreride.files.writing.folder import claim
from foreride.files.writing.sharing import shared_name

KIND = "training"
"""Of run folders of trainings, in their marker."""


def parser() -> argparse.ArgumentParser:
    """Command line of `detector train`."""
    p = Parser(prog="foreride detector train", description=__doc__)
    p.add_argument("--data", type=Path, required=True, help="folder with train/ and val/")
    p.add_argument("--out", type=Path, required=True, help="folder for checkpoint, history and weights")
    p.add_argument("--stages", default="320x192:60000,640x384:15000", help="WIDTHxHEIGHT:PASSES[,...]")
    p.add_argument("--skip-bad", action="store_true", help="leave out unusable files")
    p.add_argument("--model", choices=MODELS, default="sbp-yolo", help="architecture to train")
    p.add_argument("--batch", type=int, default=16)
    p.add_argument("--rate", type=float, default=2e-3, help="peak learning rate of AdamW")
    p.add_argument("--decay", choices=DECAYS, default="linear", help="of the rate, after its warm-up")
    p.add_argument("--nwd-alpha", type=float, default=1.0, help="share of CIoU in the box loss; 1 = no NWD")
    p.add_argument("--nwd-scale", type=float, default=12.8, help="the constant C of the NWD, in strides")
    p.add_argument("--edge-weight", type=float, default=0.0, help="weight of the row edge error (strides)")
    p.add_argument("--mosaic", type=float, default=0.0, help="share of views made of four images")
    p.add_argument("--weather", type=float, default=0.0, help="share of views with added rain, snow or fog")
    p.add_argument(
        "--litter", type=float, default=0.0, help="share of views with leaves and stones added to the road"
    )
    p.add_argument("--plain-last", type=float, default=0.1, help="share of passes at the end without mosaic")
    p.add_argument("--teacher", type=Path, help="weights file of a larger model to learn from (BCKD and CWD)")
    p.add_argument("--distil-logits", type=float, default=0.5, help="weight of BCKD; 0 = none")
    p.add_argument("--distil-features", type=float, default=0.5, help="weight of CWD; 0 = none")
    p.add_argument("--seed", type=int, default=0)
    p.add_argument("--init", type=Path, help="weights file to start from")
    p.add_argument("--resume", action="store_true", help="continue from the checkpoint in --out")
    p.add_argument("--device", default="auto", help="auto, cpu or cuda")
    p.add_argument("--precision", choices=("bf16", "fp32"), default="bf16")
    p.add_argument("--threads", type=int, default=2, help="threads of torch on a CPU")
    p.add_argument("--memory-mib", type=float, default=2048, help="for decoded images; others are read again")
    p.add_argument("--workers", type=int, default=1, help="threads that prepare batches")
    p.add_argument(
        "--patience", type=int, default=0, help="stop after N validations without improvement; 0 = never"
    )
    p.add_argument("--validate-every", type=int, default=8000, help="passes between two validations")
    return p


def main(arguments: Sequence[str] | None = None) -> int:
    """Command line; exit code 0, or 2 on bad input."""
    args = parser().parse_args(arguments)
    try:
        run(args)
    except InputError as error:
        notify(error)
        return 2
    return 0


def _settings(args: argparse.Namespace) -> Settings:
    for name in ("batch", "threads", "workers", "validate_every"):
        if getattr(args, name) < 1:
            raise InputError(f"--{name.replace('_', '-')} must be >= 1, got {getattr(args, name)}")
    for name in ("patience", "seed", "distil_logits", "distil_features"):
        if not 0 <= getattr(args, name) < math.inf:
            raise InputError(
                f"--{name.replace('_', '-')} must be finite and >= 0, got {getattr(args, name):g}"
            )
    if not 0 < args.rate < math.inf:
        raise InputError(f"--rate must be finite and > 0, got {args.rate:g}")
    return Settings(
        parse_stages(args.stages),
        args.model,
        args.batch,
        args.rate,
        decay=args.decay,
        seed=args.seed,
        precision=args.precision,
        loss=LossWeights(nwd_alpha=args.nwd_alpha, nwd_scale=args.nwd_scale, edge=args.edge_weight),
        distillation=DistillationWeights(args.distil_logits, args.distil_features),
        augmentation=Augmentation(args.mosaic, args.weather, args.litter, args.plain_last),
    )


def _device(requested: str) -> str:
    cuda = torch.cuda.is_available()
    if requested not in ("auto", "cpu", "cuda"):
        raise InputError(f"--device must be auto, cpu or cuda, got {requested!r}")
    if requested == "cuda" and not cuda:
        raise InputError("--device cuda: no CUDA device available to torch")
    return requested if requested != "auto" else "cuda" if cuda else "cpu"


def run(args: argparse.Namespace) -> None:
    """Train as specified by the command line. Raises InputError."""
    settings = _settings(args)
    device = _device(args.device)
    checkpoint = args.out / "checkpoint.pt"
    if checkpoint.exists() and not args.resume:
        raise InputError(f"{checkpoint}: already exists; add --resume to continue or choose another --out")
    if args.out.exists():
        claim(args.out, KIND)  # refused before the images are read
    torch.set_num_threads(args.threads)
    longest = max(max(stage.width, stage.height) for stage in settings.stages)
    training = load_cached_dataset(args.data / "train", max(longest, 640), args.memory_mib, args.skip_bad)
    validation = load_cached_dataset(args.data / "val", max(longest, 640), 0, args.skip_bad)
    trainer = Trainer(settings, torch.device(device), args.init, args.teacher)
    if args.resume:
        trainer.restore(checkpoint)
    claim(args.out, KIND)
    config = {"settings": asdict(settings)} | {
        name: shared_name(value) if isinstance(value, Path) else str(value)
        for name, value in vars(args).items()
    }
    write_text(args.out / "config.json", json.dumps(config, indent=1) + "\n")
    print(
        f"{len(training)} training, {len(validation)} validation images; {args.stages} on {device}",
        flush=True,
    )
    how = LoopSettings(workers=args.workers, validate_every=args.validate_every, patience=args.patience)
    train(trainer, training, validation, args.out, how)
    metadata = {
        "model": settings.model,
        "names": list(CLASS_NAMES),
        "passes": trainer.passes,
        "stages": args.stages,
        "dataset": dataset_hash(args.data / "train"),
        "settings": json.dumps(asdict(settings)),
    }
    save_weights(args.out / "weights.pt", trainer.average.model, metadata)
    write_curves(args.out)


if __name__ == "__main__":
    raise SystemExit(main())
