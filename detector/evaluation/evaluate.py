"""Evaluation of an exported detector on a labelled folder: `foreride detector eval --data DIR --json FILE`.

DIR holds images/, labels/ and optionally lane/ (PNG masks: detections centred where the mask is black are not
counted) and objects.jsonl (distance and lane of every object, for the recall by distance, and the condition
of every image). `--out FOLDER` writes metrics.json, report.txt, the curves precision_recall.png, and two
contact sheets of images with true and detected boxes there: hardest.png and typical.png. `--degrade rain`
(snow, fog, motion_blur, litter) applies that effect to the images, as in the paper's Fig. 9 c.
"""

import argparse
import json
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from foreride.detector.data.corruptions import EFFECTS, degraded
from foreride.detector.data.image_io import read_image
from foreride.detector.data.yolo_folder import Sample, dataset_hash, image_paths, read_records, read_samples
from foreride.detector.detections import Detections
from foreride.detector.evaluation.average_precision import match_detections, summarise
from foreride.detector.evaluation.by_condition import by_condition, figure_9
from foreride.detector.evaluation.by_object import EvaluatedImage, by_object, evaluated_objects, false_alarms
from foreride.detector.evaluation.contact_sheets import write_sheets
from foreride.detector.evaluation.plots import write_precision_recall
from foreride.detector.evaluation.summary import report
from foreride.detector.nms import MIN_CONFIDENCE
from foreride.detector.runtime import Detector
from foreride.detector.views import COUNTS, VIEWS_HELP
from foreride.files.command_line import Parser, notify, output_path
from foreride.files.errors import InputError
from foreride.files.progress import Progress
from foreride.files.reading.images import read_pixels
from foreride.files.reading.numbers import within
from foreride.files.writing.atomic import write_text
from foreride.files.writing.folder import claim
from foreride.files.writing.sharing import shared_name
from foreride.files.writing.targets import check_files

Change = Callable[[str, NDArray[np.uint8]], NDArray[np.uint8]]


def unchanged(name: str, image: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Identity: the image without degradation."""
    return image


def evaluate(
    folder: Path,
    detect: Callable[[NDArray[np.uint8]], Detections],
    confidence: float,
    skip_bad: bool = False,
    masks: bool = True,
) -> dict:
    """Metrics of `detect` on a folder; its confidence threshold should be far below `confidence`.

    Returns the metrics of `average_precision.summarise`, `false_alarms` on images without objects and, with
    objects.jsonl, those of `by_object` and `by_condition`. masks: whether to apply lane/. Raises InputError.
    """
    return summary_of(folder, match_folder(folder, detect, skip_bad, masks), confidence)


def summary_of(folder: Path, judged: Sequence[EvaluatedImage], confidence: float) -> dict:
    """Metrics as of `evaluate`, from a folder's judged images. Raises InputError."""
    summary = {"dataset": dataset_hash(folder)} | summarise([j.result for j in judged], confidence)
    summary["false_alarms"] = false_alarms(judged, confidence)
    records = read_records(folder)
    if records is not None:
        summary |= by_object(evaluated_objects(judged, records, confidence, folder))
        summary["by_condition"] = by_condition(judged, records, confidence)
        summary["figure_9"] = figure_9(judged, records, confidence)
    return summary


def match_folder(
    folder: Path,
    detect: Callable[[NDArray[np.uint8]], Detections],
    skip_bad: bool = False,
    masks: bool = True,
    degradation: Change = unchanged,
) -> list[EvaluatedImage]:
    """Detections in every image of a folder, matched to its labels. Raises InputError.

    degradation: applied to an image, given with its name, before detection
    """
    judged = []
    with Progress(len(image_paths(folder))) as progress:
        for sample in read_samples(folder, skip_bad=skip_bad):
            rows, columns = sample.image.shape[:2]
            detections = detect(degradation(sample.name, sample.image))
            if masks:
                detections = _in_lane(detections, sample, folder / "lane")
            boxes = sample.boxes * np.array([columns, rows, columns, rows], np.float32)
            judged.append(
                EvaluatedImage(sample.name, rows, boxes, match_detections(detections, boxes, sample.classes))
            )
            progress.show(len(judged), "evaluating")
    return judged


def _in_lane(detections: Detections, sample: Sample, masks: Path) -> Detections:
    path = masks / f"{Path(sample.name).stem}.png"
    if not path.exists():
        return detections
    mask = read_pixels(path, cv2.IMREAD_GRAYSCALE)
    size = np.array(sample.image.shape[1::-1])
    centre = (detections.boxes[:, :2] + detections.boxes[:, 2:]) / 2 / size * mask.shape[1::-1]
    x, y = centre.astype(int).clip(0, np.array(mask.shape[1::-1]) - 1).T
    in_lane = mask[y, x] > 127
    return Detections(detections.boxes[in_lane], detections.scores[in_lane], detections.classes[in_lane])


def parser() -> argparse.ArgumentParser:
    """Command line of `detector eval`."""
    p = Parser(prog="foreride detector eval", description=__doc__)
    p.add_argument("--data", type=Path, required=True, help="folder with images/ and labels/")
    p.add_argument("--weights", type=Path, help="ONNX file; the shipped one by default")
    p.add_argument("--json", type=output_path, help="write the numbers here")
    p.add_argument("--out", type=Path, help="write metrics, curves and contact sheets into this folder")
    p.add_argument("--confidence", type=float, default=0.25, help="threshold for precision and recall")
    p.add_argument("--degrade", choices=EFFECTS, help="degradation applied to every image")
    p.add_argument("--strength", type=float, default=0.5, help="strength of --degrade, 0..1")
    p.add_argument("--threads", type=int, default=1)
    p.add_argument("--views", type=int, default=1, choices=COUNTS, help=VIEWS_HELP)
    p.add_argument("--ignore-masks", action="store_true", help="count detections outside lane/ masks, too")
    p.add_argument("--skip-bad", action="store_true", help="leave out unusable files")
    return p


def main(arguments: Sequence[str] | None = None) -> int:
    """Command line; exit code 0, or 2 on bad input."""
    args = parser().parse_args(arguments)
    try:
        if not 0 < args.confidence <= 1:
            raise InputError(f"--confidence must be > 0 and <= 1, got {args.confidence:g}")
        if not 0 <= args.strength <= 1:
            raise InputError(f"--strength must be in 0..1, got {args.strength:g}")
        within("--threads", args.threads, 1, 1024)
        check_files(args.json, inputs=[args.weights])
        if args.out:
            claim(args.out, "evaluation")
        degradation = unchanged
        if args.degrade:
            degradation = partial(degraded, effect=args.degrade, strength=args.strength)
        detect = Detector(args.weights, args.threads, MIN_CONFIDENCE, views=args.views)
        judged = match_folder(args.data, detect, args.skip_bad, not args.ignore_masks, degradation)
        summary = summary_of(args.data, judged, args.confidence)
        summary |= {
            "weights": shared_name(detect.path),
            "data": shared_name(args.data),
            "metadata": detect.metadata,
            "views": args.views,
        }
        summary |= {"degrade": args.degrade, "strength": args.strength} if args.degrade else {}
        if args.json:
            write_text(args.json, json.dumps(summary, indent=1) + "\n")
        if args.out:
            write_folder(args.data, judged, summary, args.out, degradation)
    except InputError as error:
        notify(error)
        return 2
    print(report(summary))
    return 0


def write_folder(
    data: Path, judged: Sequence[EvaluatedImage], summary: dict, out: Path, degradation: Change = unchanged
) -> None:
    """Write the files of `--out`."""

    def degraded_image(name: str) -> NDArray[np.uint8]:
        return degradation(name, read_image(data / "images" / name))

    confidence = summary["confidence"]
    write_text(out / "metrics.json", json.dumps(summary, indent=1) + "\n")
    write_text(out / "report.txt", report(summary) + "\n")
    write_precision_recall([image.result for image in judged], confidence, out / "precision_recall.png")
    write_sheets(judged, degraded_image, confidence, out)


if __name__ == "__main__":
    raise SystemExit(main())
