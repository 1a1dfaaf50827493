"""Camera frames of a run: those it kept, or the same ones rendered again."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from foreride.road.camera.pinhole import CameraPose, pose_of, project
from foreride.road.render.scene import Scene
from foreride.scenarios.definition.random_streams import random_stream
from foreride.scenarios.perceptions.camera import true_mount
from foreride.scenarios.simulation.simulate import Run

LANE_M = 1.75  # half a lane


def with_frames(run: Run, advance: Callable[[], None] = lambda: None) -> Run:
    """Return the run with an image at every exposure: kept ones, or rendered again from the run's record."""
    if has_frames(run) or not run.looks:
        return run
    scenario, rng = run.case.scenario, random_stream(run.case.seed, "image")
    scene = Scene(scenario.road, scenario.appearance, int(rng.integers(2**31)))
    looks = []
    for look, pose in zip(run.looks, poses(run), strict=True):
        image = scene.render(scenario.camera.intrinsics, pose, look.tick).image
        looks.append(replace(look, image=image))
        advance()
    return replace(run, looks=looks)


def has_frames(run: Run) -> bool:
    """Whether the run kept the image of every exposure."""
    return bool(run.looks) and all(look.image is not None for look in run.looks)


def poses(run: Run) -> list[CameraPose]:
    """True camera pose at each exposure."""
    mount = true_mount(run.case.scenario, random_stream(run.case.seed, "mounting"))
    names = ("x_m", "heave_m", "pitch_rad", "roll_rad")
    columns = [run.signals.get(name, np.zeros_like(run.signals["time_s"])) for name in names]
    attitudes = ([float(column[look.tick]) for column in columns] for look in run.looks)
    return [pose_of(mount, *attitude, roll=roll) for *attitude, roll in attitudes]


def track_lines(run: Run) -> list[list[dict[str, Any]]]:
    """Estimated near edge of the tracks at each exposure: image line [u0, v0, u1, v1], class, confirmed."""
    camera = run.case.scenario.camera.intrinsics
    tracks_by_exposure = [event["tracks"] for event in run.events if event["event"] == "boxes"]
    lines = []
    for pose, tracks in zip(poses(run), tracks_by_exposure, strict=True):
        edges = [
            project(camera, pose, [(track["x_m"], y, 0.0) for y in (LANE_M, -LANE_M)]).ravel()
            for track in tracks
        ]
        lines.append(
            [
                {"line": edge.round(1).tolist(), "class": track["class"], "confirmed": track["confirmed"]}
                for edge, track in zip(edges, tracks, strict=True)
                if np.isfinite(edge).all()
            ]
        )
    return lines
