"""Differences of the boxes found in a band of the image, or by another backend, from the whole image's.

`python -m benchmarks.same_boxes --data DIR [--row 128] [--backends openvino-bf16] [--json FILE]`

DIR holds images/ and labels/, for the accuracy of each. The band, the rows from --row on, is searched with
ONNX Runtime, as the whole image is, and with each backend, which is compared with ONNX Runtime on the band.
Boxes correspond if they are of one class and overlap by an IoU of 0.5 or more; of score 0.2 in one and below
0.15 in the other, a box is lost or new. Differences are of boxes that have score 0.2 in the first.
"""

import argparse
import json
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from benchmarks.command import command
from foreride.detector.backends import require
from foreride.detector.data.yolo_folder import image_paths, read_samples
from foreride.detector.detections import Detections
from foreride.detector.evaluation.average_precision import ImageResult, match_detections, summarise
from foreride.detector.nms import MIN_CONFIDENCE, iou_matrix
from foreride.detector.runtime import Detector
from foreride.files.progress import Progress
from foreride.files.writing.atomic import write_text

COUNTED, ABSENT, IOU = 0.2, 0.15, 0.5


@dataclass
class Differences:
    """Boxes that correspond: differences of their scores and of their four edges (px), and counts."""

    scores: list[float] = field(default_factory=list)
    edges_px: list[list[float]] = field(default_factory=list)
    counted: int = 0
    lost: int = 0
    new: int = 0

    def add(self, first: Detections, second: Detections) -> None:
        """Add the boxes of one image."""
        partner = partners(first, second)
        for i in np.flatnonzero(first.scores >= COUNTED):
            j = partner[i]
            self.counted += 1
            self.lost += j < 0 or bool(second.scores[j] < ABSENT)
            if j >= 0:
                self.scores.append(float(abs(first.scores[i] - second.scores[j])))
                self.edges_px.append(np.abs(first.boxes[i] - second.boxes[j]).tolist())
        back = partners(second, first)
        for j in np.flatnonzero(second.scores >= COUNTED):
            self.new += back[j] < 0 or bool(first.scores[back[j]] < ABSENT)

    def row(self) -> dict:
        """Counts, and median, 95 % and maximum of each difference."""
        edges = np.array(self.edges_px).reshape(-1, 4)
        return {
            "counted": self.counted,
            "lost": int(self.lost),
            "new": int(self.new),
            "score": spread(np.array(self.scores)),
            "edge_px": spread(edges.max(axis=1)),
            "top_or_bottom_px": spread(edges[:, 1::2].max(axis=1)),
        }


def partners(first: Detections, second: Detections) -> np.ndarray:
    """Index (n,) of the best overlapping box of the same class in the second, -1 without one."""
    if not len(first) or not len(second):
        return np.full(len(first), -1)
    overlap = iou_matrix(first.boxes, second.boxes)
    overlap[first.classes[:, None] != second.classes[None]] = 0.0
    return np.where(overlap.max(axis=1) >= IOU, overlap.argmax(axis=1), -1)


def spread(values: np.ndarray) -> list[float] | None:
    """Median, 95 % and maximum; None of nothing."""
    return np.quantile(values, (0.5, 0.95, 1.0)).tolist() if len(values) else None


def table(data: Path, first_row: int, backends: Sequence[str]) -> dict[str, dict]:
    """Accuracy of each way, and its differences from the one before it. Raises InputError."""
    for backend in backends:
        require(backend)
    whole = Detector(confidence=MIN_CONFIDENCE)
    others = {name: Detector(confidence=MIN_CONFIDENCE, backend=name) for name in backends}
    differences = {name: Differences() for name in ("band", *backends)}
    matched: dict[str, list[ImageResult]] = {name: [] for name in ("whole", *differences)}
    with Progress(len(image_paths(data))) as progress:
        for number, sample in enumerate(read_samples(data), 1):
            image = sample.image
            found = {"whole": whole(image), "band": whole(image, first_row)}
            found |= {name: detect(image, first_row) for name, detect in others.items()}
            for name, difference in differences.items():
                difference.add(found["whole" if name == "band" else "band"], found[name])
            boxes = sample.boxes * np.tile(image.shape[1::-1], 2)
            for name, boxes_found in found.items():
                matched[name].append(match_detections(boxes_found, boxes, sample.classes))
            progress.show(number, "detecting")
    rows = {}
    for name, judged in matched.items():
        metrics = summarise(judged, COUNTED)
        rows[name] = {key: metrics[key] for key in ("map50", "map50_95", "precision", "recall")}
        rows[name] |= differences[name].row() if name in differences else {}
    return rows


@command
def main(arguments: Sequence[str] | None = None) -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--data", type=Path, required=True)
    parser.add_argument("--row", type=int, default=128, help="first row of the band (default 128)")
    parser.add_argument("--backends", default="", help="others than ONNX Runtime, as openvino-bf16")
    parser.add_argument("--json", type=Path)
    asked = parser.parse_args(arguments)
    rows = table(asked.data, asked.row, [name for name in asked.backends.split(",") if name])
    if asked.json:
        write_text(asked.json, json.dumps(rows, indent=1) + "\n")
    for name, row in rows.items():
        print(name)
        for key, value in row.items():
            shown = value if not isinstance(value, list) else " / ".join(f"{number:.3f}" for number in value)
            print(f"  {key:18} {shown:.3f}" if isinstance(shown, float) else f"  {key:18} {shown}")


if __name__ == "__main__":
    raise SystemExit(main())
