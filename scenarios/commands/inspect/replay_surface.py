"""Replay of a folder with a recorded road surface: previews of each frame, without a simulator."""

import argparse
from typing import Any

import numpy as np

from foreride.files.command_line import notify
from foreride.files.errors import InputError
from foreride.files.writing.atomic import write_text
from foreride.files.writing.folder import atomic_folder, check_folder
from foreride.scenarios.commands.console import console, tracked
from foreride.scenarios.commands.options import overrides_of
from foreride.scenarios.definition.schema import Scenario
from foreride.scenarios.recorded_surface.playback import Step, replay_surface
from foreride.scenarios.recorded_surface.sequence import SurfaceSequence
from foreride.scenarios.replay.outputs import KIND
from foreride.scenarios.replay.replay_scenario import replay_scenario
from foreride.scenarios.runs.write import environment, preview_table, to_json, to_parquet
from foreride.scenarios.simulation import preview_log

_NEAR_M = (1.0, 6.0)
"""Distances of which the summary tells the uncertainty."""


def execute_surface(arguments: argparse.Namespace) -> int:
    """Replay a folder, write the previews, print a summary."""
    folder = arguments.log
    if arguments.images or arguments.signal:
        option = "--images" if arguments.images else "--signal"
        raise InputError(
            f"{option} must be left out for the folder {folder}, which holds all that it replays"
        )
    out = arguments.out or folder.with_name(f"{folder.resolve().name}-replay")
    check_folder(out, KIND)
    scenario = replay_scenario(arguments.scenario, None, overrides_of(arguments), folder)
    sequence = SurfaceSequence(folder, arguments.stereo)
    if sequence.without_pose:
        notify(f"{sequence.without_pose} frames have no pose and are left out")
    steps = list(
        tracked(replay_surface(sequence, scenario, arguments.stereo), "replaying", len(sequence.frames))
    )
    told = summary(sequence, steps, scenario)
    wheel = int(np.argmin(scenario.vehicle.parameters.wheel_y_m))
    log = preview_log.collect([preview_log.decimated(step.preview, wheel) for step in steps])
    with atomic_folder(out, KIND) as draft:
        draft.write("summary.json", to_json(told | {"manifest": environment()}) + "\n")
        draft.write("previews.parquet", to_parquet(preview_table(log)))
    console.print(
        f"{told['frames']} frames, {told['distance_m']:.1f} m, heights {_NEAR_M[0]:g} to "
        f"{_NEAR_M[1]:g} m ahead to {1e3 * told['height_sigma_m']:.1f} mm: {out}/"
    )
    if arguments.json:
        write_text(arguments.json, to_json(told) + "\n")
    return 0


def summary(sequence: SurfaceSequence, steps: list[Step], scenario: Scenario) -> dict[str, Any]:
    """Counts, distance, and the mean standard deviation and existence of the previewed heights."""
    distance = steps[0].preview.distance_m
    near = (distance > _NEAR_M[0]) & (distance < _NEAR_M[1])
    later = steps[len(steps) // 2 :]
    return {
        "schema": 1,
        "log": sequence.folder.resolve().name,
        "scenario": scenario.name,
        "vehicle": scenario.vehicle.model,
        "frames": len(steps),
        "without_pose": sequence.without_pose,
        "duration_s": sequence.frames[-1].time_s,
        "distance_m": steps[-1].x_m,
        "points": sum(step.points for step in steps),
        "camera_height_m": float(np.median([step.camera_height_m for step in steps])),
        "height_sigma_m": float(np.mean([step.preview.height_sigma_m[:, near] for step in later])),
        "existence": float(np.mean([step.preview.existence[:, near] for step in later])),
    }
