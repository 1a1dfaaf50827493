"""Text report of an evaluation."""


def report(summary: dict) -> str:
    """Summary of an evaluation as a few lines of text."""
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
        for side in ("top", "bottom"):
            rows = summary[f"{side}_edge_4_10_m"]
            parts = (
                f"{name} {_shown(row['bias_px'])} +- {_shown(row['sigma_px'])} px of {row['objects']}"
                for name, row in rows.items()
            )
            lines.append(f"{side} edge, 4-10 m, down is +: " + ", ".join(parts))
    false = summary["false_alarms"]
    lines.append(f"plain road: {_shown(false['per_100_images'])} false per 100 of {false['images']} images")
    return "\n".join(lines + _condition_lines(summary.get("figure_9", {})))


def _condition_lines(rows: dict) -> list[str]:
    """Table of the conditions of the paper's Fig. 9."""
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
