"""Folder of a replay: summary, tracks, detections, events, preview, and a figure."""

from pathlib import Path
from typing import Any

from foreride.detector.detections import CLASS_NAMES
from foreride.files.writing.folder import atomic_folder
from foreride.scenarios.definition.schema import Scenario
from foreride.scenarios.replay.figure import replay_figure
from foreride.scenarios.replay.playback import Replay
from foreride.scenarios.replay.recording import Signals
from foreride.scenarios.report.figures.files import encoded
from foreride.scenarios.runs.write import environment, preview_table, to_json, to_parquet

KIND = "replay"
"""Kind of replay folders in their marker."""
TRACK_COLUMNS = (
    "track",
    "class",
    "x_m",
    "sigma_m",
    "length_m",
    "height_m",
    "existence",
    "hits",
    "last_seen_s",
)
"""Columns of the table of tracks: positions on the odometer, which begins at `start_m` of the scenario."""


def summary(result: Replay, signals: Signals, scenario: Scenario, log: Path) -> dict[str, Any]:
    """Counts, distance and tracks of a replay."""
    found = [int(cls) for look in result.looks for cls in look.detections.classes]
    speed = signals.values["speed_m_s"]
    return {
        "schema": 1,
        "log": log.name,
        "scenario": scenario.name,
        "vehicle": scenario.vehicle.model,
        "start_s": signals.start_s,
        "duration_s": float(signals.times_s[-1]),
        "distance_m": float((0.5 * (speed[1:] + speed[:-1])).sum() / scenario.control.rate_hz),
        "images": len(result.looks),
        "images_left_out": result.left_out,
        "boxes": {name: found.count(cls) for cls, name in enumerate(CLASS_NAMES)},
        "tracks": [result.tracks[number] for number in sorted(result.tracks)],
    }


def write_replay(result: Replay, told: dict[str, Any], signals: Signals, out: Path) -> None:
    """Write the folder of a replay, atomically."""
    looks = [
        {"time_s": look.time_s, "boxes": found.boxes, "scores": found.scores, "classes": found.classes}
        for look in result.looks
        for found in [look.detections]
    ]
    with atomic_folder(out, KIND) as draft:
        draft.write("summary.json", to_json(told | {"manifest": environment()}) + "\n")
        for name, rows in (("events.jsonl", result.events), ("boxes.jsonl", looks)):
            draft.write(name, "".join(to_json(row, indent=None) + "\n" for row in rows))
        draft.write("previews.parquet", to_parquet(preview_table(result.previews)))
        draft.write("replay.png", next(encoded(replay_figure(result, signals))))
