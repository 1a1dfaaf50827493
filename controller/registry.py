"""Controllers by name, and controllers of the user's own."""

import importlib.util
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from types import ModuleType
from typing import Any, NamedTuple

from controller.base import Controller, Timing
from controller.mpc import MpcSettings, PredictiveController
from controller.passive import Passive, PassiveSettings
from controller.skyhook import Skyhook, SkyhookSettings
from files.errors import InputError
from files.strict import structure
from vehicle.parameters import Car

Factory = Callable[..., Controller]
"""(vehicle, settings, timing) → controller."""


class Entry(NamedTuple):
    """A controller that can be built by name, and the dataclass of its settings."""

    make: Factory
    settings: type


CONTROLLERS: dict[str, Entry] = {
    "passive": Entry(Passive, PassiveSettings),
    "skyhook": Entry(Skyhook, SkyhookSettings),
    "mpc_reactive": Entry(partial(PredictiveController, uses_preview=False), MpcSettings),
    "mpc_preview": Entry(PredictiveController, MpcSettings),
}


def build(
    name: str,
    vehicle: Car,
    settings: Mapping[str, Any] | None = None,
    timing: Timing | None = None,
) -> Controller:
    """Build the controller called `name`, or the user's own named as `path/to/file.py:name`.

    settings: fields of the controller's settings dataclass that differ from their defaults; for the user's
    own,
    the keyword arguments of its class or function beyond (vehicle, timing).
    Raises InputError for a name or a setting that does not exist, and for values out of range.
    """
    timing = timing or Timing()
    if ":" in name:
        return _build_user(name, vehicle, dict(settings or {}), timing)
    if name not in CONTROLLERS:
        raise InputError(f"controller must be one of {', '.join(CONTROLLERS)} or FILE.py:NAME, got {name!r}")
    entry = CONTROLLERS[name]
    return entry.make(vehicle, structure(entry.settings, dict(settings or {}), f"controller {name}"), timing)


def load_user_controller(target: str) -> Factory:
    """Return the class or function that `path/to/file.py:name` names.

    It is called as name(vehicle, timing, **settings) and returns an object with `reset()` and
    `step(estimate, preview)`. Raises InputError, in one line, where file or name are missing or do not load.
    """
    path_text, _, name = target.rpartition(":")
    path = Path(path_text)
    if path.suffix != ".py" or not path.is_file():
        raise InputError(f"controller {target}: {path_text!r} must be an existing .py file")
    factory = getattr(_load(path, target), name, None)
    if not callable(factory):
        raise InputError(f"controller {target}: {path} must define a class or function called {name!r}")
    return factory


def _load(path: Path, target: str) -> ModuleType:
    spec = importlib.util.spec_from_file_location(f"user_controller_{path.stem}", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    try:
        spec.loader.exec_module(module)
    except Exception as error:  # a user's file may raise anything
        raise InputError(f"controller {target}: {path} does not load ({_tell(error)})") from error
    return module


def _build_user(target: str, vehicle: Car, settings: dict[str, Any], timing: Timing) -> Controller:
    factory = load_user_controller(target)
    try:
        controller = factory(vehicle, timing, **settings)
    except InputError:
        raise
    except Exception as error:  # a user's code may raise anything
        raise InputError(f"controller {target}: cannot be built ({_tell(error)})") from error
    missing = [method for method in ("reset", "step") if not callable(getattr(controller, method, None))]
    if missing:
        raise InputError(f"controller {target}: must have reset() and step(), lacks {', '.join(missing)}")
    return controller


def _tell(error: Exception) -> str:
    return f"{type(error).__name__}: {error}".replace("\n", " ")
