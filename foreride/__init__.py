"""Preview suspension in closed loop: camera, detector, road preview, damper controller, car, ride comfort.

The names in `__all__` are the public interface; they are imported when they are first used, so that importing
this package takes a few milliseconds and loads neither CasADi nor MuJoCo. Everything else may change.
"""

import importlib
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from foreride.comfort import ride_metrics
    from foreride.controller.interface import Controller, Estimate
    from foreride.detector.runtime import Detector
    from foreride.drives import bound, compare, load_run, load_scenario, run
    from foreride.extensions import (
        register_controller,
        register_damper,
        register_feature,
        register_metric,
        register_perception,
    )
    from foreride.files.errors import InputError
    from foreride.outputs import report, sweep
    from foreride.preview.road_preview import RoadPreview
    from foreride.results import Comparison, Result
    from foreride.road.road import Road
    from foreride.vehicle.linear_model import linear_twin
    from foreride.vehicle.load import load_vehicle

_PLACES = {
    "Comparison": "results",
    "Controller": "controller.interface",
    "Detector": "detector.runtime",
    "Estimate": "controller.interface",
    "InputError": "files.errors",
    "Result": "results",
    "Road": "road.road",
    "RoadPreview": "preview.road_preview",
    "bound": "drives",
    "compare": "drives",
    "linear_twin": "vehicle.linear_model",
    "load_run": "drives",
    "load_scenario": "drives",
    "load_vehicle": "vehicle.load",
    "register_controller": "extensions",
    "register_damper": "extensions",
    "register_feature": "extensions",
    "register_metric": "extensions",
    "register_perception": "extensions",
    "report": "outputs",
    "ride_metrics": "comfort",
    "run": "drives",
    "sweep": "outputs",
}
__all__ = [
    "Comparison", "Controller", "Detector", "Estimate", "InputError", "Result", "Road", "RoadPreview",
    "bound", "compare", "linear_twin", "load_run", "load_scenario", "load_vehicle", "register_controller",
    "register_damper", "register_feature", "register_metric", "register_perception", "report",
    "ride_metrics", "run", "sweep",
]  # fmt: skip

_CHECKOUT = Path(__file__).resolve().parents[1]
if (_CHECKOUT / "pyproject.toml").is_file() and (_CHECKOUT / "road").is_dir():
    # A wheel holds the packages inside this folder; in a checkout they stand beside it.
    __path__.append(str(_CHECKOUT))


if not TYPE_CHECKING:  # or a type checker would take every name for a public one

    def __getattr__(name: str) -> Any:
        """Import a public name when it is first used (PEP 562)."""
        if name not in _PLACES:
            raise AttributeError(f"module 'foreride' has no attribute {name!r}")
        value = getattr(importlib.import_module(f"foreride.{_PLACES[name]}"), name)
        globals()[name] = value
        return value


def __dir__() -> list[str]:
    """The public names, for completion."""
    return sorted(__all__)
