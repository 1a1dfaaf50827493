"""Score an exported detector on a labelled folder: `python -m detector.evaluate --data DIR --json FILE`.

DIR holds images/, labels/ and optionally lane/ (PNG masks: detections centred where the mask is black
are not counted) and objects.jsonl (distance and lane of every object, for the recall by distance).
"""

import argparse
import json
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from detector.dataset import Sample, dataset_hash, image_paths, read_objects, read_samples
from detector.detection import CLASS_NAMES, Detections
from detector.metrics import ImageResult, judge, summarise
from detector.progress import Progress
from detector.runtime import Detector
from files.atomic import write_text
from files.errors import InputError

LEAST_CONFIDENCE = 0.001
BIN_M = 2.5
EGO_RANGE_M = (4.0, 15.0)


def evaluate(
    folder: Path,
    detect: Callable[[NDArray[np.uint8]], Detections],
    confidence: float,
    skip_bad: bool = False,
) -> dict:
    """Metrics of `detect` on a folder; it should answer with a far lower threshold than `confidence`.

    Gives what `metrics.summarise` does and, where objects.jsonl is there, `ego_recall` (objects in the
    own lane 4-15 m ahead) and `recall_by_distance`. Raises InputError.
    """
    results = []
    objects = read_objects(folder)
    with Progress(len(image_paths(folder))) as progress:
        for sample in read_samples(folder, skip_bad=skip_bad):
            rows, columns = sample.image.shape[:2]
            found = _in_lane(detect(sample.image), sample, folder / "lane")
            boxes = sample.boxes * np.array([columns, rows, columns, rows], np.float32)
            results.append((sample.name, judge(found, boxes, sample.classes)))
            progress.show(len(results), "evaluating")
    summary = {"dataset": dataset_hash(folder)} | summarise([r for _, r in results], confidence)
    return summary if objects is None else summary | _recall_of_objects(results, objects, confidence, folder)


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


def _recall_of_objects(
    results: Sequence[tuple[str, ImageResult]],
    objects: dict[str, list[dict]],
    confidence: float,
    folder: Path,
) -> dict:
    rows = []  # class, distance, in ego lane, found
    for name, result in results:
        records = objects.get(name, [])
        if [r.get("class") for r in records] != result.truth_classes.tolist():
            raise InputError(f"{folder / 'objects.jsonl'}: objects of {name} differ from its label file")
        scores = np.append(result.detections.scores, 0.0)[result.found]
        for record, score in zip(records, scores, strict=True):
            rows.append((record["class"], record["distance_m"], record["in_ego_lane"], score >= confidence))
    table = np.array(rows, float).reshape(-1, 4)
    ego = table[table[:, 2] == 1]
    near = ego[(ego[:, 1] >= EGO_RANGE_M[0]) & (ego[:, 1] <= EGO_RANGE_M[1])]
    return {
        "ego_range_m": list(EGO_RANGE_M),
        "ego_recall": _recall(near),
        "ego_recall_by_distance": _by_distance(ego),
        "recall_by_distance": _by_distance(table),
    }


def _recall(table: NDArray) -> dict:
    """Recall and count of all rows and of each class."""
    parts = {"all": table} | {name: table[table[:, 0] == i] for i, name in enumerate(CLASS_NAMES)}
    return {
        name: {"objects": len(part), "recall": float(part[:, 3].mean()) if len(part) else None}
        for name, part in parts.items()
    }


def _by_distance(table: NDArray) -> list[dict]:
    bins = np.floor(table[:, 1] / BIN_M).astype(int)
    return [
        {"from_m": b * BIN_M, "to_m": (b + 1) * BIN_M} | _recall(table[bins == b])
        for b in sorted(set(bins.tolist()))
    ]


def parser() -> argparse.ArgumentParser:
    p = argparse.ArgumentParser(prog="python -m detector.evaluate", description=__doc__)
    p.add_argument("--data", type=Path, required=True, help="folder with images/ and labels/")
    p.add_argument("--weights", type=Path, help="ONNX file; the shipped one by default")
    p.add_argument("--json", type=Path, help="write the numbers here")
    p.add_argument("--confidence", type=float, default=0.25, help="threshold for precision and recall")
    p.add_argument("--threads", type=int, default=1)
    p.add_argument("--skip-bad", action="store_true", help="leave out files that cannot be used")
    return p


def main(arguments: Sequence[str] | None = None) -> int:
    args = parser().parse_args(arguments)
    try:
        detect = Detector(args.weights, args.threads, LEAST_CONFIDENCE)
        summary = evaluate(args.data, detect, args.confidence, args.skip_bad)
        summary |= {"weights": str(detect.path), "data": str(args.data), "metadata": detect.metadata}
        if args.json:
            write_text(args.json, json.dumps(summary, indent=1) + "\n")
    except InputError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    print(report(summary))
    return 0


def report(summary: dict) -> str:
    """The chief numbers as a few lines of text."""

    def shown(value: float | None) -> str:
        return "  -  " if value is None else f"{value:.3f}"

    lines = [f"{summary['images']} images, threshold {summary['confidence']:g}"]
    lines.append(f"{'':12}  AP50  AP50-95  P      R")
    keys = ("ap50", "ap50_95", "precision", "recall")
    for name, row in summary["per_class"].items():
        lines.append(f"{name:12}  " + "  ".join(shown(row[k]) for k in keys))
    keys = ("map50", "map50_95", "precision", "recall")
    lines.append(f"{'mean':12}  " + "  ".join(shown(summary[k]) for k in keys))
    if "ego_recall" in summary:
        ego = summary["ego_recall"]
        parts = (f"{name} {shown(row['recall'])} of {row['objects']}" for name, row in ego.items())
        lines.append("own lane, 4-15 m ahead: " + ", ".join(parts))
    return "\n".join(lines)


if __name__ == "__main__":
    raise SystemExit(main())
