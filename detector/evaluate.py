"""Score an exported detector on a labelled folder: `foreride detector eval --data DIR --json FILE`.

DIR holds images/, labels/ and optionally lane/ (PNG masks: detections centred where the mask is black
are not counted) and objects.jsonl (distance and lane of every object, for the recall by distance, and the
condition of every image). With `--out FOLDER` this writes there metrics.json, report.txt, the curves
precision_recall.png, and two sheets of images with true and found boxes: hardest.png and typical.png.
"""

import argparse
import json
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from detector.breakdown import Judged, by_object, false_alarms, objects_seen
from detector.conditions import by_condition, figure_9
from detector.curves import write_precision_recall
from detector.dataset import Sample, dataset_hash, image_paths, read_records, read_samples
from detector.detection import Detections
from detector.gallery import write_sheets
from detector.metrics import judge, summarise
from detector.progress import Progress
from detector.runtime import Detector
from files.atomic import write_text
from files.errors import InputError

LEAST_CONFIDENCE = 0.001


def evaluate(
    folder: Path,
    detect: Callable[[NDArray[np.uint8]], Detections],
    confidence: float,
    skip_bad: bool = False,
    masks: bool = True,
) -> dict:
    """Metrics of `detect` on a folder; it should answer with a far lower threshold than `confidence`.

    Gives what `metrics.summarise` does, `false_alarms` on images without objects and, where objects.jsonl is
    there, what `breakdown` tells of objects and conditions. masks: mind lane/. Raises InputError.
    """
    return summary_of(folder, judge_folder(folder, detect, skip_bad, masks), confidence)


def summary_of(folder: Path, judged: Sequence[Judged], confidence: float) -> dict:
    """The metrics that `evaluate` gives, of a folder's images judged before. Raises InputError."""
    summary = {"dataset": dataset_hash(folder)} | summarise([j.result for j in judged], confidence)
    summary["false_alarms"] = false_alarms(judged, confidence)
    records = read_records(folder)
    if records is not None:
        summary |= by_object(objects_seen(judged, records, confidence, folder))
        summary["by_condition"] = by_condition(judged, records, confidence)
        summary["figure_9"] = figure_9(judged, records, confidence)
    return summary


def judge_folder(
    folder: Path,
    detect: Callable[[NDArray[np.uint8]], Detections],
    skip_bad: bool = False,
    masks: bool = True,
) -> list[Judged]:
    """Every image of a folder, detected and held against its labels. Raises InputError."""
    judged = []
    with Progress(len(image_paths(folder))) as progress:
        for sample in read_samples(folder, skip_bad=skip_bad):
            rows, columns = sample.image.shape[:2]
            found = detect(sample.image)
            if masks:
                found = _in_lane(found, sample, folder / "lane")
            boxes = sample.boxes * np.array([columns, rows, columns, rows], np.float32)
            judged.append(Judged(sample.name, rows, boxes, judge(found, boxes, sample.classes)))
            progress.show(len(judged), "evaluating")
    return judged


def _in_lane(found: Detections, sample: Sample, masks: Path) -> Detections:
    path = masks / f"{Path(sample.name).stem}.png"
    if not path.exists():
        return found
    mask = cv2.imread(str(path), cv2.IMREAD_GRAYSCALE)
    if mask is None:
        raise InputError(f"{path}: cannot be decoded as a mask")
    size = np.array(sample.image.shape[1::-1])
    centre = (found.boxes[:, :2] + found.boxes[:, 2:]) / 2 / size * mask.shape[1::-1]
    x, y = centre.astype(int).clip(0, np.array(mask.shape[1::-1]) - 1).T
    inside = mask[y, x] > 127
    return Detections(found.boxes[inside], found.scores[inside], found.classes[inside])


def parser() -> argparse.ArgumentParser:
    p = argparse.ArgumentParser(prog="foreride detector eval", description=__doc__)
    p.add_argument("--data", type=Path, required=True, help="folder with images/ and labels/")
    p.add_argument("--weights", type=Path, help="ONNX file; the shipped one by default")
    p.add_argument("--json", type=Path, help="write the numbers here")
    p.add_argument("--out", type=Path, help="write numbers, curves and sheets of images into this folder")
    p.add_argument("--confidence", type=float, default=0.25, help="threshold for precision and recall")
    p.add_argument("--threads", type=int, default=1)
    p.add_argument("--ignore-masks", action="store_true", help="count detections outside lane/ masks, too")
    p.add_argument("--skip-bad", action="store_true", help="leave out files that cannot be used")
    return p


def main(arguments: Sequence[str] | None = None) -> int:
    args = parser().parse_args(arguments)
    try:
        if not 0 < args.confidence <= 1:
            raise InputError(f"--confidence must be in 0..1, got {args.confidence:g}")
        detect = Detector(args.weights, args.threads, LEAST_CONFIDENCE)
        judged = judge_folder(args.data, detect, args.skip_bad, not args.ignore_masks)
        summary = summary_of(args.data, judged, args.confidence)
        summary |= {"weights": str(detect.path), "data": str(args.data), "metadata": detect.metadata}
        if args.json:
            write_text(args.json, json.dumps(summary, indent=1) + "\n")
        if args.out:
            write_folder(args.data, judged, summary, args.out)
    except InputError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    print(report(summary))
    return 0


def write_folder(data: Path, judged: Sequence[Judged], summary: dict, out: Path) -> None:
    """What `--out` asks for."""
    confidence = summary["confidence"]
    write_text(out / "metrics.json", json.dumps(summary, indent=1) + "\n")
    write_text(out / "report.txt", report(summary) + "\n")
    write_precision_recall([image.result for image in judged], confidence, out / "precision_recall.png")
    write_sheets(data, judged, confidence, out)


def report(summary: dict) -> str:
    """The chief numbers as a few lines of text."""
    lines = [f"{summary['images']} images, threshold {summary['confidence']:g}"]
    lines.append(f"{'':12}  AP50  AP50-95  P      R")
    keys = ("ap50", "ap50_95", "precision", "recall")
    for name, row in summary["per_class"].items():
        lines.append(f"{name:12}  " + "  ".join(_shown(row[k]) for k in keys))
    keys = ("map50", "map50_95", "precision", "recall")
    lines.append(f"{'mean':12}  " + "  ".join(_shown(summary[k]) for k in keys))
    if "ego_recall" in summary:
        ego = summary["ego_recall"]
        parts = (f"{name} {_shown(row['recall'])} of {row['objects']}" for name, row in ego.items())
        lines.append("own lane, 4-15 m ahead: " + ", ".join(parts))
        edge = summary["bottom_edge_4_10_m"]["all"]
        bias, sigma = _shown(edge["bias_px"]), _shown(edge["sigma_px"])
        lines.append(f"bottom edge, 4-10 m: bias {bias} px, sigma {sigma} px of {edge['objects']}")
    false = summary["false_alarms"]
    lines.append(f"plain road: {_shown(false['per_100_images'])} false per 100 of {false['images']} images")
    return "\n".join(lines + _condition_lines(summary.get("figure_9", {})))


def _condition_lines(rows: dict) -> list[str]:
    """The conditions of the paper's Fig. 9 as a table."""
    if not rows:
        return []
    lines = [f"{'':12}  mAP50  AP50-95  P      R      images"]
    keys = ("map50", "map50_95", "precision", "recall")
    return lines + [
        f"{name:12}  " + "  ".join(_shown(row[key]) for key in keys) + f"  {row['images']}"
        for name, row in rows.items()
    ]


def _shown(value: float | None) -> str:
    return "  -  " if value is None else f"{value:.3f}"


if __name__ == "__main__":
    raise SystemExit(main())
