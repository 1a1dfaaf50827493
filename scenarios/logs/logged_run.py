"""Run to be logged: its record, and the camera images as the run folder holds them."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from foreride.files.errors import InputError
from foreride.files.reading.regular_file import read_bytes
from foreride.files.reading.strict_json import parse_json
from foreride.files.writing.sharing import shared_target
from foreride.scenarios.runs.read import read
from foreride.scenarios.runs.write import definition, frame_name, to_json
from foreride.scenarios.simulation.simulate import Run

RECORD = "foreride"
"""Name under which a log holds the run's scenario and metrics."""


@dataclass(frozen=True)
class LoggedRun:
    """Run with its images: JPEG files by the tick of their exposure, empty if the run kept none."""

    run: Run
    images: dict[int, bytes]

    def record(self) -> dict[str, str]:
        """Text of what identifies the run: its scenario and metrics as JSON, controller, perception, seed."""
        case = self.run.case
        return {
            "scenario": to_json(definition(case.scenario), indent=None),
            "controller": shared_target(case.controller),
            "perception": case.perception,
            "seed": str(case.seed),
            "metrics": to_json(self.run.metrics, indent=None),
        }


def recorded_scenario(record: Any, place: str) -> dict[str, Any]:
    """Fields of the scenario in a record; InputError naming `place` if they are not there."""
    text = record.get("scenario") if isinstance(record, dict) else None
    fields = parse_json(text, place) if isinstance(text, str) else None
    if not isinstance(fields, dict):
        raise InputError(f"{place}: must hold a scenario, as `foreride log` writes it")
    return fields


def read_logged(folder: Path) -> LoggedRun:
    """Read a run folder with its images. Raises InputError."""
    run = read(folder)
    ticks = [look.tick for look in run.looks if look.image is not None]
    return LoggedRun(run, {tick: read_bytes(folder / frame_name(tick)) for tick in ticks})
