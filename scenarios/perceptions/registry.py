"""Registry of perceptions by name: the ladder from no preview to the camera."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from foreride.files.errors import InputError, shown
from foreride.files.own_code import error_text, waiting_for
from foreride.files.plugins import Registry
from foreride.preview.elevation.range_sensor import PRESETS
from foreride.scenarios.perceptions.camera import MEMORY_FILE, WEIGHTS_FILE, build_boxes, build_camera
from foreride.scenarios.perceptions.elevation import build_elevation, preset_builder
from foreride.scenarios.perceptions.interface import Drive, Perception, ReferencedFile
from foreride.scenarios.perceptions.oracle import build_obstacles, build_oracle
from foreride.scenarios.perceptions.road_map import MAP, build_map


@dataclass(frozen=True)
class PerceptionEntry:
    """Registered perception.

    label: its source of the preview, in reports. files: those of a scenario that it reads. looks_ahead:
    whether it gives a preview. has_estimator: whether it tracks obstacles from boxes, which needs the car's
    sensors even under a controller that does not.
    """

    build: Callable[[Drive], Perception]
    label: str
    files: tuple[ReferencedFile, ...] = ()
    looks_ahead: bool = True
    has_estimator: bool = False


_OWN = {
    "none": PerceptionEntry(lambda drive: Perception(), "no preview", looks_ahead=False),
    "oracle": PerceptionEntry(build_oracle, "true road"),
    "obstacles": PerceptionEntry(build_obstacles, "true obstacles"),
    "map": PerceptionEntry(build_map, "map of the road", files=(MAP,)),
    "elevation": PerceptionEntry(build_elevation, "elevation map", has_estimator=True),
    **{
        preset.kind: PerceptionEntry(preset_builder(preset), preset.label, has_estimator=True)
        for preset in PRESETS
    },
    "boxes": PerceptionEntry(build_boxes, "true boxes with errors", files=(MEMORY_FILE,), has_estimator=True),
    "camera": PerceptionEntry(
        build_camera, "camera and detector", files=(WEIGHTS_FILE, MEMORY_FILE), has_estimator=True
    ),
}


def _accept(name: str, value: Any) -> PerceptionEntry:
    """Entry of a package or user: a `PerceptionEntry`, or a class or function (drive) → perception."""
    entry = PerceptionEntry(value, name) if callable(value) else value
    if not isinstance(entry, PerceptionEntry):
        raise InputError(f"must be a class, a function or a PerceptionEntry, got {shown(value)}")

    def build(drive: Drive) -> Perception:
        try:
            with waiting_for(f"perception {name}"):
                perception = entry.build(drive)
        except (InputError, KeyboardInterrupt):
            raise
        except BaseException as error:  # user code may raise anything, even SystemExit
            told = error_text(error, Path())
            raise InputError(f"perception {name}: cannot be built ({told})") from error
        if not isinstance(perception, Perception):
            raise InputError(f"perception {name}: must derive from Perception, got {shown(perception)}")
        return perception

    return replace(entry, build=build)


PERCEPTIONS: Registry[PerceptionEntry] = Registry("foreride.perceptions", "perception", _OWN, _accept)
"""In the order of a ladder: each is nearer to a real car than the one before; then the added ones."""


def perception_entry(name: str) -> PerceptionEntry:
    """Entry of the perception called `name`; InputError if there is none."""
    entry = PERCEPTIONS.find(name)
    if entry is None:
        raise InputError(f"perception must be one of {', '.join(PERCEPTIONS.names())}, got {shown(name)}")
    return entry
