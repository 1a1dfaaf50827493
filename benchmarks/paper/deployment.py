"""Table 5 of arXiv 2508.01339: size, latency and accuracy in FP32, FP16 and INT8, in one run.

`python -m benchmarks.paper.deployment --data DIR --calibrate DIR [--json FILE]`

DIR holds images/ and labels/; INT8 is calibrated on other images than those of the evaluation. All rows read
the same images, and are timed in turn (see `foreride.detector.export.benchmark`). Losses are in points of
mAP50 against the first row; times are relative to the first row, too. Needs the extra training.
"""

import argparse
import json
import tempfile
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from benchmarks.command import command
from foreride.detector.backends import BACKENDS, installed, require
from foreride.detector.data.yolo_folder import image_paths, read_samples
from foreride.detector.evaluation.average_precision import match_detections, summarise
from foreride.detector.export.benchmark import Case, measure, prepare
from foreride.detector.nms import MIN_CONFIDENCE
from foreride.detector.runtime import WEIGHTS, Detector
from foreride.files.errors import InputError
from foreride.files.progress import Progress
from foreride.files.writing.atomic import write_text

PRECISIONS = ("fp32", "fp16", "int8")


def accuracy(files: dict[Case, Path], data: Path, every: int) -> dict[Case, dict]:
    """Metrics of each row on every `every`-th image of a folder."""
    detectors = {c: Detector(f, c.threads, MIN_CONFIDENCE, backend=c.backend) for c, f in files.items()}
    results: dict[Case, list] = {case: [] for case in files}
    with Progress(len(image_paths(data))) as progress:
        for number, sample in enumerate(read_samples(data), 1):
            if number % every == 0:
                boxes = sample.boxes * np.tile(sample.image.shape[1::-1], 2)
                for case, detect in detectors.items():
                    results[case].append(match_detections(detect(sample.image), boxes, sample.classes))
            progress.show(number, "judging")
    return {case: summarise(found, 0.25) for case, found in results.items()}


def check(args: argparse.Namespace) -> None:
    """Raise InputError for counts below 1, or if no image would be evaluated."""
    for name in ("threads", "runs", "every"):
        if getattr(args, name) < 1:
            raise InputError(f"--{name} must be >= 1, got {getattr(args, name)}")
    images = len(image_paths(args.data))
    if args.every > images:
        raise InputError(
            f"--every must be <= {images}, the number of images in {args.data}, got {args.every}"
        )


def table(args: argparse.Namespace) -> list[dict]:
    """One row per backend and precision. Raises InputError."""
    check(args)
    for backend in args.backends.split(","):
        require(backend)
    cases = [
        Case("sbp-yolo", "optimised", precision, backend, args.size, args.threads)
        for backend in args.backends.split(",")
        for precision in PRECISIONS
    ]
    with tempfile.TemporaryDirectory() as folder:
        files = prepare(cases, Path(folder), args.weights, args.calibrate)
        sizes = {case: path.stat().st_size / 2**20 for case, path in files.items()}
        times = measure(files, args.runs)
        found = accuracy(files, args.data, args.every)
    rows = [
        time | {"size_mib": sizes[case], **{k: found[case][k] for k in ("map50", "map50_95", "images")}}
        for case, time in zip(files, times, strict=True)
    ]
    for row in rows:
        row["loss_points"] = 100 * (rows[0]["map50"] - row["map50"])
        row["relative_time"] = row["median_ms"] / rows[0]["median_ms"]
        row["relative_cpu_time"] = row["median_cpu_ms"] / rows[0]["median_cpu_ms"]
    return rows


def parser() -> argparse.ArgumentParser:
    p = argparse.ArgumentParser(description=__doc__)
    p.add_argument("--data", type=Path, required=True, help="labelled folder for the evaluation")
    p.add_argument("--calibrate", type=Path, required=True, help="folder with images/ for the ranges of INT8")
    p.add_argument("--weights", type=Path, default=WEIGHTS.with_suffix(".pt"), help="of `detector train`")
    usable = [name for name in installed() if name in ("cpu", "openvino", "openvino-bf16")]
    p.add_argument(
        "--backends", default=",".join(usable), help=f"of {', '.join(BACKENDS)} (default %(default)s)"
    )
    p.add_argument("--every", type=int, default=1, help="evaluate every Nth image")
    p.add_argument("--size", default="640x384")
    p.add_argument("--threads", type=int, default=1)
    p.add_argument("--runs", type=int, default=30)
    p.add_argument("--json", type=Path)
    return p


@command
def main(arguments: Sequence[str] | None = None) -> None:
    args = parser().parse_args(arguments)
    rows = table(args)
    print(f"{rows[0]['images']} images, {args.size}, {args.threads} threads\n")
    print(
        "| backend | precision | MiB | ms | relative | relative, processor | mAP50 | mAP50-95 | points lost |"
    )
    print("|---|---|---|---|---|---|---|---|---|")
    for r in rows:
        times = f"{r['median_ms']:.1f} | {r['relative_time']:.2f} | {r['relative_cpu_time']:.2f}"
        hits = f"{r['map50']:.3f} | {r['map50_95']:.3f} | {r['loss_points']:+.1f}"
        print(f"| {r['backend']} | {r['precision']} | {r['size_mib']:.1f} | {times} | {hits} |")
    if args.json:
        write_text(args.json, json.dumps(rows, indent=1) + "\n")


if __name__ == "__main__":
    raise SystemExit(main())
