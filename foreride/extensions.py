"""Extensions: base classes and registration of own dampers, road features, perceptions, controllers, metrics.

An installed package declares its parts as entry points, and every process that uses foreride finds them:

    [project.entry-points."foreride.dampers"]
    maxwell = "my_package:Maxwell"

The other groups are foreride.features, foreride.perceptions, foreride.controllers and foreride.metrics; an
entry's name is the part's name. The functions `register_...` add a part to the running
process; worker processes (`--jobs`, `foreride sweep`) know it only if they register it, too, as a script does
at its top level outside `if __name__ == "__main__"`. Names are taken once; `replace` renews an own one.
"""

from collections.abc import Callable
from typing import Any

from foreride.comfort.registry import METRICS, Column, Metric, Tolerance
from foreride.controller.interface import Controller
from foreride.controller.registry import CONTROLLERS
from foreride.road.features.feature import FEATURES, RoadFeature
from foreride.scenarios.perceptions.interface import Drive, Perception
from foreride.scenarios.perceptions.registry import PERCEPTIONS, PerceptionEntry
from foreride.vehicle.dampers.damper import DAMPERS, DamperModel

__all__ = [
    "Column", "DamperModel", "Drive", "Metric", "Perception", "PerceptionEntry", "RoadFeature", "Tolerance",
    "register_controller", "register_damper", "register_feature", "register_metric", "register_perception",
]  # fmt: skip


def register_damper(cls: type[DamperModel], replace: bool = False) -> type[DamperModel]:
    """Add a kind of damper, a frozen dataclass; usable as a class decorator."""
    DAMPERS.register(_kind(cls), cls, replace)
    return cls


def register_feature(cls: type[RoadFeature], replace: bool = False) -> type[RoadFeature]:
    """Add a kind of road feature, a frozen dataclass; usable as a class decorator."""
    FEATURES.register(_kind(cls), cls, replace)
    return cls


def register_perception(
    name: str, perception: Callable[[Drive], Perception] | PerceptionEntry, replace: bool = False
) -> None:
    """Add a perception: a class or function (drive) → perception, or an entry with label and files."""
    PERCEPTIONS.register(name, perception, replace)


def register_controller(name: str, factory: Callable[..., Controller], replace: bool = False) -> None:
    """Add a controller: a class or function (vehicle, timing, **settings) → controller.

    Its settings are those of `control.settings.user`. It runs once with each perception, unless the factory
    has an attribute `uses_preview` that is false.
    """
    CONTROLLERS.register(name, factory, replace)


def register_metric(metric: Metric, replace: bool = False) -> None:
    """Add a metric, which is computed for every run from then on."""
    METRICS.register(str(getattr(metric, "name", "")), metric, replace)


def _kind(cls: Any) -> str:
    return str(getattr(cls, "kind", getattr(cls, "__name__", "")))
