"""Registry of controllers by name, and loading of user-defined controllers."""

import importlib.util
from collections.abc import Callable
from functools import partial
from pathlib import Path
from types import ModuleType
from typing import NamedTuple

from controller.base import Controller, Timing
from controller.damper_inverse import Inverted, is_linear
from controller.hybrid import Hybrid
from controller.lqr_clipped import ClippedLqr
from controller.mpc import PredictiveController
from controller.passive import fixed, passive
from controller.pdd import PowerDriven
from controller.settings import ControllerSettings
from controller.skyhook import Skyhook
from controller.supervisor import Supervised
from controller.tuned import tuned_settings
from controller.two_state import TwoState, add, groundhook, sh_add, skyhook2
from files.errors import InputError
from vehicle.parameters import Car, prediction_car

Factory = Callable[..., Controller]
"""(vehicle, settings, timing) → controller."""


class Entry(NamedTuple):
    """Registered controller.

    settings: the field of `ControllerSettings` it takes, if any. sees_ahead: whether it uses a preview.
    knows_damper: whether it commands settings of the car's own damper; others command coefficients.
    """

    make: Factory
    settings: str | None = None
    sees_ahead: bool = False
    knows_damper: bool = False


CONTROLLERS: dict[str, Entry] = {
    "passive": Entry(passive, "passive", knows_damper=True),
    "fixed": Entry(fixed, "fixed", knows_damper=True),
    "skyhook": Entry(Skyhook, "skyhook"),
    "skyhook2": Entry(partial(TwoState, law=skyhook2), "skyhook2"),
    "groundhook": Entry(partial(TwoState, law=groundhook), "groundhook"),
    "hybrid": Entry(Hybrid, "hybrid"),
    "add": Entry(partial(TwoState, law=add), "add"),
    "sh_add": Entry(sh_add, "sh_add"),
    "pdd": Entry(PowerDriven, "pdd"),
    "lqr_clipped": Entry(ClippedLqr, "lqr_clipped"),
    "mpc_reactive": Entry(partial(PredictiveController, sight="none"), "mpc", knows_damper=True),
    "mpc_wheelbase": Entry(partial(PredictiveController, sight="wheelbase"), "mpc", knows_damper=True),
    "mpc_preview": Entry(PredictiveController, "mpc", sees_ahead=True, knows_damper=True),
}

CLAIRVOYANT = "clairvoyant"
"""Replay of a drive's optimum; only the closed loop can build it, as it belongs to one drive."""

UNSUPERVISED = ("passive", "fixed")
"""Controllers that cannot fail and therefore need no supervisor."""


def build(
    name: str, vehicle: Car, settings: ControllerSettings | None = None, timing: Timing | None = None
) -> Controller:
    """Build the controller called `name`, or the user's own named as `path/to/file.py:name`.

    Without settings it is tuned as shipped for the vehicle's kind. It knows the vehicle as `prediction_car`
    has it, without the inner states of its dampers.
    Raises InputError for a name that does not exist and for settings that do not fit the vehicle.
    """
    settings, timing = settings or tuned_settings(vehicle.kind), timing or Timing()
    vehicle = prediction_car(vehicle)
    controller = _make(name, vehicle, settings, timing)
    if name in UNSUPERVISED:
        return controller
    reactive = _make(settings.supervisor.reactive, vehicle, settings, timing)
    safe = _make("fixed", vehicle, settings, timing)
    return Supervised(controller, reactive, safe, vehicle, settings.supervisor, timing)


def _make(name: str, vehicle: Car, settings: ControllerSettings, timing: Timing) -> Controller:
    if _is_user(name):
        return _build_user(name, vehicle, settings.user, timing)
    entry = _entry(name)
    law = entry.make(vehicle, getattr(settings, entry.settings) if entry.settings else None, timing)
    return law if entry.knows_damper or is_linear(vehicle) else Inverted(law, vehicle)


def sees_ahead(name: str) -> bool:
    """Whether the controller called `name` uses a preview; of the user's own that is taken to be so.

    Raises InputError for a name that does not exist.
    """
    return name != CLAIRVOYANT and (_is_user(name) or _entry(name).sees_ahead)


def _is_user(name: str) -> bool:
    return ":" in name


def _entry(name: str) -> Entry:
    if name not in CONTROLLERS:
        known = ", ".join([*CONTROLLERS, CLAIRVOYANT])
        raise InputError(f"controller must be one of {known} or FILE.py:NAME, got {name!r}")
    return CONTROLLERS[name]


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


def _build_user(target: str, vehicle: Car, settings: dict[str, float], timing: Timing) -> Controller:
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
