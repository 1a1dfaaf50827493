"""Plots of training curves over image passes, and of precision and recall, as PNG files."""

import io
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from foreride.detector.detections import CLASS_NAMES
from foreride.detector.evaluation.average_precision import (
    IOU_LEVELS,
    ImageResult,
    average_precision,
    pooled,
    precision_recall,
)
from foreride.files.errors import InputError
from foreride.files.reading.regular_file import reading
from foreride.files.reading.strict_json import read_json_lines
from foreride.files.writing.atomic import write_bytes

if TYPE_CHECKING:
    from matplotlib.figure import Figure


SCORES = {"map50": "mAP50", "map50_95": "mAP50-95", "recall": "recall at 0.25"}


def read_history(path: Path) -> list[dict]:
    """Rows of a `history.jsonl`: passes, scores (None where there was nothing to find), loss terms.

    Raises InputError naming the line that lacks one of them or holds another value than a number.
    """
    rows = read_json_lines(path)
    for number, row in enumerate(rows, 1):
        with reading(f"{path}:{number}"):
            numbers = [row["passes"], *(row[key] for key in SCORES), *row.get("loss", {}).values()]
            if type(numbers[0]) is not int or not all(_shape_matches(value) for value in numbers):
                raise InputError(f"{path}:{number}: passes, scores and loss must be numbers")
    return rows


def _shape_matches(value: object) -> bool:
    return value is None or (type(value) in (int, float) and abs(value) <= 1e12)  # type: ignore[arg-type]


def write_curves(run: Path) -> None:
    """Plot `history.jsonl` of a run folder to `curves.png`; no file without a history."""
    history = run / "history.jsonl"
    rows = read_history(history) if history.exists() else []
    if not rows:
        return
    passes = [row["passes"] for row in rows]
    figure = _figure()
    losses, scores = figure.subplots(1, 2)
    terms = [row.get("loss", {}) for row in rows]  # empty where a finished run was resumed
    for name in dict.fromkeys(name for row in terms for name in row):
        losses.plot(passes, [row.get(name) for row in terms], ".-", label=name)
    for key, label in SCORES.items():
        scores.plot(passes, [row[key] for row in rows], ".-", label=label)
    for axes, title in ((losses, "loss"), (scores, "validation")):
        axes.set(xlabel="image passes", title=title)
        if axes.lines:
            axes.legend()
        axes.grid(alpha=0.3)
    _write(figure, run / "curves.png")


def write_precision_recall(results: Sequence[ImageResult], confidence: float, path: Path) -> None:
    """Plot precision over recall at IoU 0.5 and 0.75 for each class, and both over the threshold at IoU 0.5.

    A dot, and a line on the right, mark `confidence`. Classes without objects are left out.
    """
    figure = _figure()
    curve, threshold = figure.subplots(1, 2)
    for cls, name in enumerate(CLASS_NAMES):
        scores, hits, truths = pooled(results, cls)
        if not truths:
            continue
        for level, style in ((0, "-"), (5, ":")):
            sorted_scores, precision, recall = precision_recall(scores, hits[level], truths)
            ap = average_precision(scores, hits[level], truths)
            label = f"{name}, IoU {IOU_LEVELS[level]:.2f}: AP {ap:.3f}"
            curve.plot(recall, precision, style, color=f"C{cls}", label=label)
            if level == 0:
                count_above = int((sorted_scores >= confidence).sum())
                curve.plot(recall[:count_above][-1:], precision[:count_above][-1:], "o", color=f"C{cls}")
                threshold.plot(sorted_scores, precision, "-", color=f"C{cls}", label=f"precision, {name}")
                threshold.plot(sorted_scores, recall, "--", color=f"C{cls}", label=f"recall, {name}")
    threshold.axvline(confidence, color="0.5", linewidth=0.8, label=f"threshold {confidence:g}")
    curve.set(xlabel="recall", ylabel="precision", xlim=(0, 1), ylim=(0, 1.01))
    threshold.set(xlabel="confidence threshold", xlim=(0, 1), ylim=(0, 1.01))
    for axes in (curve, threshold):
        if axes.lines:
            axes.legend(fontsize=7, loc="lower left" if axes is curve else "lower right", framealpha=0.7)
        axes.grid(alpha=0.3)
    _write(figure, path)


def _figure() -> "Figure":
    from matplotlib.figure import Figure  # imported here, so that training starts without it

    return Figure(figsize=(9, 3.5), layout="constrained")


def _write(figure: "Figure", path: Path) -> None:
    stream = io.BytesIO()
    figure.savefig(stream, format="png", dpi=110)
    write_bytes(path, stream.getvalue())
