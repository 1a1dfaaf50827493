"""Table 4 of arXiv 2508.01339: SBP-YOLO and other detectors, trained on the same images.

`python -m benchmarks.paper.detectors --data DIR --out FOLDER --passes 60000 [--rows a,b] [--json FILE]`

DIR holds train/ and val/. Every row starts from random weights (D-FINE-N with `--d-fine-weights FOLDER` from
those of its authors, see `benchmarks.paper.dfine`) and is trained for the same number of images
at the same size; all are evaluated by the same code on DIR/val. Our models and D-FINE-N see the same batches;
the rows of the package ultralytics, which the user has to install, use its own augmentation. An interrupted
run can be restarted.
"""

import argparse
import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
import torch
from numpy.typing import NDArray

from benchmarks.command import command
from benchmarks.paper import dfine, with_ultralytics
from benchmarks.paper.training import check_same_settings, record_settings, settings_of, train_ours
from foreride.detector.data.crops import whole_view
from foreride.detector.data.yolo_folder import Sample, read_samples
from foreride.detector.detections import Detections
from foreride.detector.evaluation.average_precision import match_detections, summarise
from foreride.detector.network.checkpoint import load_network
from foreride.detector.network.complexity import parameters
from foreride.detector.network.deployed import Deployed
from foreride.detector.network.models import Network
from foreride.detector.nms import MIN_CONFIDENCE, NMS_IOU, select
from foreride.detector.training.schedule import Stage, parse_stages
from foreride.files.progress import Progress
from foreride.files.writing.atomic import write_text
from foreride.scenarios.tables.options import parse_words

OURS = ("sbp-yolo", "yolo11n")
ROWS = (*OURS, "d-fine-n", *with_ultralytics.YOLOS)


class Trained(NamedTuple):
    """Trained detector: number of parameters, training images seen, and the detection function."""

    parameters: int
    passes: int
    detect: Callable[[NDArray[np.uint8]], Detections]


def trained(name: str, stage: Stage, args: argparse.Namespace) -> Trained:
    """Train the row of that name, unless its folder is complete. Raises InputError."""
    out = args.out / name
    if name in OURS:
        train_ours(out, stage, args, "--model", name)
        model, made = load_network(out / "weights.pt")
        return Trained(parameters(model), int(made["passes"]), detector(model))
    record_settings(out, _settings(name, stage, args))
    if name == "d-fine-n":
        start = args.d_fine_weights
        rival, passes = dfine.train(args.data / "train", stage, out, args.batch, args.seed, start)
        return Trained(sum(p.numel() for p in rival.parameters()), passes, dfine.detector(rival))
    yolo, passes = with_ultralytics.train(name, args.data, stage, out, args.batch, args.seed)
    return Trained(with_ultralytics.parameters(yolo), passes, with_ultralytics.detector(yolo))


def check(names: Sequence[str], stage: Stage, args: argparse.Namespace) -> None:
    """Raise InputError for anything that would stop a later row after hours of training."""
    for name in names:
        if name in with_ultralytics.YOLOS:
            with_ultralytics.package(name)
        elif name == "d-fine-n":
            dfine.check(stage)
            dfine.build(args.d_fine_weights)
        check_same_settings(args.out / name, _settings(name, stage, args))


def _settings(name: str, stage: Stage, args: argparse.Namespace) -> dict:
    """Settings of a row; those of D-FINE-N tell where pre-trained weights came from."""
    start = {"pretrained": str(args.d_fine_weights)} if name == "d-fine-n" and args.d_fine_weights else {}
    return settings_of(stage, args) | start


def detector(model: Network) -> Callable[[NDArray[np.uint8]], Detections]:
    """Detection function of one of our networks."""
    deployed = Deployed(model)

    def detect(image: NDArray[np.uint8]) -> Detections:
        with torch.inference_mode():
            boxes, scores = deployed(torch.from_numpy(image)[None])
        return select(boxes[0].numpy(), scores[0].numpy(), MIN_CONFIDENCE, NMS_IOU)

    return detect


def judged(
    detect: Callable[[NDArray[np.uint8]], Detections], samples: Sequence[Sample], stage: Stage
) -> dict:
    """Metrics of a detector on whole images at the stage's size."""
    results = []
    with Progress(len(samples)) as progress:
        for sample in samples:
            image, classes, boxes = whole_view(sample, stage.width, stage.height)
            asked = classes >= 0
            results.append(
                match_detections(detect(np.ascontiguousarray(image)), boxes[asked], classes[asked])
            )
            progress.show(len(results), "judging")
    return summarise(results, 0.25)


def table(args: argparse.Namespace) -> list[dict]:
    """Train, evaluate and print every row requested. Raises InputError."""
    names = parse_words("--rows", args.rows, ROWS)
    (stage,) = parse_stages(f"{args.size}:{args.passes}")
    check(names, stage, args)
    torch.set_num_threads(args.threads)
    samples = list(read_samples(args.data / "val", max(stage.width, stage.height, 640)))
    rows = []
    print("| detector | parameters M | passes | mAP50 | mAP50-95 | P | R |\n|---|---|---|---|---|---|---|")
    for name in names:
        row = trained(name, stage, args)
        found = judged(row.detect, samples, stage)
        kept = ("map50", "map50_95", "precision", "recall", "images", "per_class")
        rows.append({"row": name, "parameters": row.parameters, "passes": row.passes, "size": args.size})
        rows[-1] |= {key: found[key] for key in kept}
        numbers = " | ".join("-" if found[k] is None else f"{found[k]:.3f}" for k in kept[:4])
        print(f"| {name} | {row.parameters / 1e6:.2f} | {row.passes} | {numbers} |", flush=True)
        if args.json:
            write_text(args.json, json.dumps(rows, indent=1) + "\n")
    return rows


def parser() -> argparse.ArgumentParser:
    p = argparse.ArgumentParser(description=__doc__)
    p.add_argument("--data", type=Path, required=True, help="folder with train/ and val/")
    p.add_argument("--out", type=Path, required=True, help="folder for the run folders of the rows")
    p.add_argument("--rows", default="sbp-yolo,yolo11n,d-fine-n", help=f"of {', '.join(ROWS)}")
    p.add_argument("--passes", type=int, default=60000, help="image passes of every row")
    p.add_argument("--size", default="640x384")
    p.add_argument("--batch", type=int, default=16)
    p.add_argument("--seed", type=int, default=0)
    p.add_argument("--threads", type=int, default=2)
    p.add_argument("--d-fine-weights", type=Path, metavar="FOLDER", help="pre-trained, of transformers")
    p.add_argument("--json", type=Path)
    return p


@command
def main(arguments: Sequence[str] | None = None) -> None:
    table(parser().parse_args(arguments))


if __name__ == "__main__":
    raise SystemExit(main())
