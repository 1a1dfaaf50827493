"""Registry of perceptions by name: the ladder from no preview to the camera."""

from collections.abc import Callable
from dataclasses import dataclass

from foreride.files.errors import InputError, shown
from foreride.scenarios.perceptions.camera import MEMORY_FILE, WEIGHTS_FILE, build_boxes, build_camera
from foreride.scenarios.perceptions.interface import Drive, Perception, ReferencedFile
from foreride.scenarios.perceptions.oracle import build_oracle
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


PERCEPTIONS: dict[str, PerceptionEntry] = {
    "none": PerceptionEntry(lambda drive: Perception(), "no preview", looks_ahead=False),
    "oracle": PerceptionEntry(build_oracle, "true road"),
    "map": PerceptionEntry(build_map, "map of the road", files=(MAP,)),
    "boxes": PerceptionEntry(build_boxes, "true boxes with errors", files=(MEMORY_FILE,), has_estimator=True),
    "camera": PerceptionEntry(
        build_camera, "camera and detector", files=(WEIGHTS_FILE, MEMORY_FILE), has_estimator=True
    ),
}
"""In the order of a ladder: each is nearer to a real car than the one before."""


def perception_entry(name: str) -> PerceptionEntry:
    """Entry of the perception called `name`; InputError if there is none."""
    if name not in PERCEPTIONS:
        raise InputError(f"perception must be one of {', '.join(PERCEPTIONS)}, got {shown(name)}")
    return PERCEPTIONS[name]
