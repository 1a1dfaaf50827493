"""Training of SBP-YOLO on a folder of labelled images: `foreride detector train --data DIR --out RUN`.

DIR holds train/ and val/, each with images/ and labels/. RUN receives config.json, checkpoint.pt (resume with
`--resume`), history.jsonl (periodic validations), predictions/ (detections in a few images, at each
validation), tensorboard/ (`tensorboard --logdir RUN`) and, at the end, curves.png and weights.pt. The same
command runs on a CPU and on a GPU.
"""

import argparse
import json
import math
from collections.abc import Iterator, Sequence, Set
from contextlib import AbstractContextManager, nullcontext
from dataclasses import asdict
from pathlib import Path
from typing import cast

import torch

from foreride.detector.data.augment import Augmentation
from foreride.detector.data.yolo_folder import dataset_hash
from foreride.detector.detections import CLASS_NAMES
from foreride.detector.evaluation.plots import write_curves
from foreride.detector.network.auxiliary import obstacles_only
from foreride.detector.network.checkpoint import save_weights
from foreride.detector.training.batches import Batch, batches
from foreride.detector.training.device.arrivals import Arrivals
from foreride.detector.training.device.feed import DeviceAugmentation, DeviceFeed
from foreride.detector.training.device.precision import fastest_precision
from foreride.detector.training.distillation import DistillationWeights
from foreride.detector.training.image_store import CachedDataset, load_cached_dataset
from foreride.detector.training.loop import LoopSettings, train
from foreride.detector.training.losses import LossWeights
from foreride.detector.training.mixture import Mixture
from foreride.detector.training.options import parser
from foreride.detector.training.schedule import parse_stages
from foreride.detector.training.trainer import Settings, Trainer
from foreride.files.command_line import notify
from foreride.files.errors import InputError, shown
from foreride.files.writing.atomic import write_text
from foreride.files.writing.folder import claim
from foreride.files.writing.sharing import shared_name

KIND = "training"
"""Of run folders of trainings, in their marker."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Command line; exit code 0, or 2 on bad input."""
    args = parser(__doc__).parse_args(arguments)
    try:
        run(args)
    except InputError as error:
        notify(error)
        return 2
    return 0


def _settings(args: argparse.Namespace, device: str) -> Settings:
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
        precision=fastest_precision(device) if args.precision == "auto" else args.precision,
        loss=LossWeights(nwd_alpha=args.nwd_alpha, nwd_scale=args.nwd_scale, edge=args.edge_weight),
        distillation=DistillationWeights(args.distil_logits, args.distil_features),
        augmentation=Augmentation(args.mosaic, args.weather, args.litter, args.plain_last, args.zoom),
        auxiliary=args.auxiliary,
    )


def _mixture(args: argparse.Namespace, longest: int) -> Mixture:
    """The training images, and those of `--mix` at their shares."""
    folders, shares = [args.data / "train"], []
    for text in args.mix:
        folder, _, share = text.rpartition("=")
        try:
            shares.append(float(share))
        except ValueError:
            raise InputError(
                f"--mix must be DIR=SHARE, with a share such as 0.2, got {shown(text)}"
            ) from None
        folders.append(Path(folder))
    memory_mib = args.memory_mib / len(folders)
    how = longest, memory_mib, args.skip_bad, args.auxiliary
    return Mixture([load_cached_dataset(one, *how) for one in folders], shares)


def _feed(
    args: argparse.Namespace,
    trainer: Trainer,
    training: Mixture,
    on_device: DeviceAugmentation | None,
    arrivals: Arrivals | None,
) -> Iterator[Batch]:
    """Batches of views made on the device or, without settings for it, on the host. Raises InputError."""
    settings = trainer.settings
    if on_device is None:
        order = (settings.stages, settings.batch, trainer.passes, settings.seed, args.workers)
        return batches(training, *order, settings.augmentation)
    more = arrivals.taken if arrivals else tuple
    feed = DeviceFeed(training, trainer.device, settings.seed, on_device, more)
    return feed.batches(settings.stages, settings.batch, trainer.passes)


def _arrivals(
    args: argparse.Namespace, training: Mixture, longest: int
) -> AbstractContextManager[Arrivals | None]:
    """Reader of the images that `--data` gains while the training runs; None without `--grow`."""
    if not args.grow:
        return nullcontext()
    folder = args.data / "train"

    def read(only: Set[str]) -> CachedDataset:
        return load_cached_dataset(folder, longest, 0, args.skip_bad, args.auxiliary, only)

    return Arrivals(folder, read, {path.name for path in cast(CachedDataset, training.sets[0]).paths})


def _device_views(args: argparse.Namespace, device: str) -> DeviceAugmentation | None:
    """Settings of views made on the device; None for views made on the host. Raises InputError."""
    if args.views == "host" or (args.views == "auto" and device == "cpu"):
        if args.grow:
            raise InputError("--grow: must come with --views device")
        return None
    for name in ("mosaic", "weather", "litter"):
        if getattr(args, name):
            raise InputError(f"--{name}: device views have none; must come with --views host")
    return DeviceAugmentation(args.zoom, args.style)


def _device(requested: str) -> str:
    cuda = torch.cuda.is_available()
    if requested not in ("auto", "cpu", "cuda"):
        raise InputError(f"--device must be auto, cpu or cuda, got {requested!r}")
    if requested == "cuda" and not cuda:
        raise InputError("--device cuda: no CUDA device available to torch")
    return requested if requested != "auto" else "cuda" if cuda else "cpu"


def run(args: argparse.Namespace) -> None:
    """Train as specified by the command line. Raises InputError."""
    device = _device(args.device)
    settings = _settings(args, device)
    on_device = _device_views(args, device)
    checkpoint = args.out / "checkpoint.pt"
    if checkpoint.exists() and not args.resume:
        raise InputError(f"{checkpoint}: already exists; add --resume to continue or choose another --out")
    if args.out.exists():
        claim(args.out, KIND)  # refused before the images are read
    torch.set_num_threads(args.threads)
    torch.backends.cudnn.benchmark = device == "cuda"  # sizes of images are few, and each is used for long
    longest = max(max(stage.width, stage.height) for stage in settings.stages)
    training = _mixture(args, max(longest, 640))
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
        f"{len(training)} training, {len(validation)} validation images; {args.stages} on {device} "
        f"in {settings.precision}",
        flush=True,
    )
    how = LoopSettings(validate_every=args.validate_every, patience=args.patience)
    with _arrivals(args, training, max(longest, 640)) as arrivals:
        feed = _feed(args, trainer, training, on_device, arrivals)
        train(trainer, feed, validation, args.out, how)
    metadata = {
        "model": settings.model,
        "names": list(CLASS_NAMES),
        "passes": trainer.passes,
        "stages": args.stages,
        "dataset": dataset_hash(args.data / "train"),
        "settings": json.dumps(asdict(settings)),
    }
    save_weights(args.out / "weights.pt", obstacles_only(trainer.average.model), metadata)
    write_curves(args.out)


if __name__ == "__main__":
    raise SystemExit(main())
