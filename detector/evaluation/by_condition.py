"""Detection metrics by imaging condition: light, weather and blur, including those of the paper's Fig. 9.

Uses the `condition` that `objects.jsonl` records for every image (arXiv 2508.01339, section 3.7).
"""

from collections.abc import Callable, Sequence

from foreride.detector.evaluation.average_precision import ImageResult, summarise
from foreride.detector.evaluation.by_object import EvaluatedImage

BLURRED_PX = 2.0
"""Threshold of motion blur (pixels that a point travels during the exposure) of a blurred image."""
REPORTED_METRICS = ("map50", "map50_95", "precision", "recall", "images")

Condition = dict[str, object]


def _is_blurred(condition: Condition) -> bool:
    blur = condition.get("motion_blur_px", 0.0)
    return isinstance(blur, int | float) and blur >= BLURRED_PX


def _is_fair(condition: Condition) -> bool:
    """Reference condition: a dry day without glare or blur."""
    bright = condition.get("light") in ("noon", "overcast") and condition.get("weather") == "dry"
    return bright and not condition.get("low_sun") and not _is_blurred(condition)


FIGURE_9: dict[str, Callable[[Condition], bool]] = {
    "fair": _is_fair,
    "night": lambda c: c.get("light") == "night",
    "sunset": lambda c: c.get("light") == "sunset",
    "low sun": lambda c: bool(c.get("low_sun")),
    "rain": lambda c: c.get("weather") == "rain",
    "snow": lambda c: c.get("weather") == "snow",
    "fog": lambda c: c.get("weather") == "fog",
    "motion blur": _is_blurred,
}
"""Conditions of the paper's Fig. 9, b and c, and two more: fair, as the reference, and fog."""


def by_condition(judged: Sequence[EvaluatedImage], records: dict[str, dict], confidence: float) -> dict:
    """Metrics of the images in each recorded condition: light, weather and so on."""
    groups: dict[str, list[ImageResult]] = {}
    for image in judged:
        condition = _of(image, records)
        grouped_condition = condition | (
            {"motion_blur_px": _blur_group(condition)} if "motion_blur_px" in condition else {}
        )
        for key, value in grouped_condition.items():
            groups.setdefault(f"{key}: {value}", []).append(image.result)
    summaries = {name: summarise(group, confidence) for name, group in sorted(groups.items())}
    return {name: {key: summary[key] for key in REPORTED_METRICS} for name, summary in summaries.items()}


def figure_9(judged: Sequence[EvaluatedImage], records: dict[str, dict], confidence: float) -> dict:
    """Metrics of the images in each condition of `FIGURE_9` that occurs, with AP50 by class."""
    rows = {}
    for name, predicate in FIGURE_9.items():
        group = [image.result for image in judged if predicate(_of(image, records))]
        if group:
            summary = summarise(group, confidence)
            ap50 = {cls: row["ap50"] for cls, row in summary["per_class"].items()}
            objects = sum(row["objects"] for row in summary["per_class"].values())
            rows[name] = {key: summary[key] for key in REPORTED_METRICS} | {"objects": objects, "ap50": ap50}
    return rows


def _of(image: EvaluatedImage, records: dict[str, dict]) -> Condition:
    return records.get(image.name, {}).get("condition", {})


def _blur_group(condition: Condition) -> str:
    return f"from {BLURRED_PX:g}" if _is_blurred(condition) else f"under {BLURRED_PX:g}"
