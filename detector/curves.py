"""Curves of a training: losses and validation over the image passes, as one PNG."""

import json
from pathlib import Path


def write_curves(run: Path) -> None:
    """Draw `history.jsonl` of a run folder into `curves.png`; nothing where there is no history."""
    from matplotlib.figure import Figure  # only here, so that training starts without it

    history = run / "history.jsonl"
    if not history.exists():
        return
    rows = [json.loads(line) for line in history.read_text().splitlines()]
    passes = [row["passes"] for row in rows]
    figure = Figure(figsize=(9, 3.5), layout="constrained")
    losses, scores = figure.subplots(1, 2)
    for name in rows[-1]["loss"]:
        losses.plot(passes, [row["loss"].get(name) for row in rows], ".-", label=name)
    for key, label in (("map50", "mAP50"), ("map50_95", "mAP50-95"), ("recall", "recall at 0.25")):
        scores.plot(passes, [row[key] for row in rows], ".-", label=label)
    for axes, title in ((losses, "loss"), (scores, "validation")):
        axes.set(xlabel="image passes", title=title)
        axes.legend()
        axes.grid(alpha=0.3)
    figure.savefig(run / "curves.png", dpi=110)
