"""Registry of controllers by name; those named by a file are in `controller.user_controller`."""

import inspect
from collections.abc import Callable
from functools import partial
from typing import Any, NamedTuple

from foreride.controller.interface import Controller, MonitoredController, Timing
from foreride.controller.laws.damper_inverse import EquivalentDamping, is_linear
from foreride.controller.laws.hybrid import Hybrid
from foreride.controller.laws.lqr_clipped import ClippedLqr
from foreride.controller.laws.passive import fixed, passive
from foreride.controller.laws.power_driven import PowerDriven
from foreride.controller.laws.skyhook import Skyhook
from foreride.controller.laws.two_state import TwoState, add, groundhook, sh_add, skyhook2
from foreride.controller.mpc.controller import PredictiveController
from foreride.controller.settings import ControllerSettings
from foreride.controller.supervision.supervisor import FallbackSupervisor
from foreride.controller.tuned_settings import settings_for
from foreride.controller.user_controller import Factory as UserFactory
from foreride.controller.user_controller import build_user_controller, is_user_controller
from foreride.files.errors import InputError, shown
from foreride.files.plugins import Registry
from foreride.vehicle.load import Car, control_model

Factory = Callable[..., MonitoredController]
"""(vehicle, settings, timing) → controller."""


class ControllerEntry(NamedTuple):
    """Registered controller.

    settings: the field of `ControllerSettings` it takes, if any. uses_preview: whether it uses a preview.
    commands_settings: whether it commands settings of the car's own damper; others command coefficients.
    summary: a line for listings.
    """

    make: Factory
    settings: str | None = None
    uses_preview: bool = False
    commands_settings: bool = False
    summary: str = ""


_OWN = {
    "passive": ControllerEntry(
        passive, "passive", commands_settings=True, summary="the car's dampers as built"
    ),
    "fixed": ControllerEntry(
        fixed, "fixed", commands_settings=True, summary="one damping coefficient per axle"
    ),
    "fixed_best": ControllerEntry(
        fixed, "fixed_best", commands_settings=True, summary="the best fixed damping: the passive reference"
    ),
    "skyhook": ControllerEntry(Skyhook, "skyhook", summary="continuous skyhook with a groundhook part"),
    "skyhook2": ControllerEntry(
        partial(TwoState, law=skyhook2), "skyhook2", summary="two-state (on–off) skyhook"
    ),
    "groundhook": ControllerEntry(
        partial(TwoState, law=groundhook), "groundhook", summary="two-state (on–off) groundhook"
    ),
    "hybrid": ControllerEntry(Hybrid, "hybrid", summary="hybrid skyhook–groundhook"),
    "add": ControllerEntry(partial(TwoState, law=add), "add", summary="acceleration-driven damper"),
    "sh_add": ControllerEntry(sh_add, "sh_add", summary="mixed skyhook–ADD"),
    "pdd": ControllerEntry(PowerDriven, "pdd", summary="power-driven damper"),
    "lqr_clipped": ControllerEntry(
        ClippedLqr, "lqr_clipped", summary="linear-quadratic regulator, clipped to what a damper can do"
    ),
    "mpc_reactive": ControllerEntry(
        partial(PredictiveController, preview_source="none"),
        "mpc",
        commands_settings=True,
        summary="model predictive control without a preview",
    ),
    "mpc_wheelbase": ControllerEntry(
        partial(PredictiveController, preview_source="wheelbase"),
        "mpc",
        commands_settings=True,
        summary="model predictive control whose front axle measures the road for the rear one",
    ),
    "mpc_preview": ControllerEntry(
        PredictiveController,
        "mpc",
        uses_preview=True,
        commands_settings=True,
        summary="model predictive control with the road ahead",
    ),
}


def _accept(name: str, value: Any) -> ControllerEntry:
    """Entry of a class or function (vehicle, timing, **settings) → controller, as a controller file has."""
    if not callable(value):
        raise InputError(f"must be a class or function, got {shown(value)}")

    def make(vehicle: Car, settings: dict[str, float], timing: Timing) -> MonitoredController:
        return build_user_controller(value, vehicle, settings, timing)

    previewed = bool(getattr(value, "uses_preview", True))
    summary = (inspect.getdoc(value) or "your own").partition("\n")[0]
    return ControllerEntry(make, "user", previewed, commands_settings=True, summary=summary)


CONTROLLERS: Registry[ControllerEntry] = Registry("foreride.controllers", "controller", _OWN, _accept)

CLAIRVOYANT = "clairvoyant"
"""Replay of a drive's optimum; only the closed loop can build it, as it belongs to one drive."""

UNSUPERVISED = ("passive", "fixed", "fixed_best")
"""Controllers that cannot fail and therefore need no supervisor."""


def build(
    name: str, vehicle: Car, settings: ControllerSettings | None = None, timing: Timing | None = None
) -> MonitoredController:
    """Build the controller called `name`, or one from a file, `path/to/file.py:name` or `file.fmu`.

    Without settings it is tuned as shipped for the vehicle's kind. It is given the vehicle's control model
    (`control_model`), without the internal states of its dampers.
    Raises InputError for an unknown name and for settings that do not fit the vehicle.
    """
    settings, timing = settings or settings_for(vehicle), timing or Timing()
    vehicle = control_model(vehicle)
    controller = _make(name, vehicle, settings, timing)
    return controller if name in UNSUPERVISED else _supervised(controller, vehicle, settings, timing)


def build_object(
    controller: Controller | UserFactory, vehicle: Car, settings: ControllerSettings, timing: Timing
) -> MonitoredController:
    """Supervise a controller given as an object, or as a class or function that is called to build it.

    Its failures are treated like those of a controller from a file. Raises InputError if it cannot be built.
    """
    vehicle = control_model(vehicle)
    built = build_user_controller(controller, vehicle, settings.user, timing)
    return _supervised(built, vehicle, settings, timing)


def _supervised(
    controller: MonitoredController, vehicle: Car, settings: ControllerSettings, timing: Timing
) -> MonitoredController:
    reactive = _make(settings.supervisor.reactive, vehicle, settings, timing)
    safe = _make("fixed", vehicle, settings, timing)
    return FallbackSupervisor(controller, reactive, safe, vehicle, settings.supervisor, timing)


def _make(name: str, vehicle: Car, settings: ControllerSettings, timing: Timing) -> MonitoredController:
    if is_user_controller(name):
        return build_user_controller(name, vehicle, settings.user, timing)
    entry = _entry(name)
    law = entry.make(vehicle, getattr(settings, entry.settings) if entry.settings else None, timing)
    return law if entry.commands_settings or is_linear(vehicle) else EquivalentDamping(law, vehicle)


def uses_preview(name: str) -> bool:
    """Whether the controller called `name` uses a preview; of the user's own that is taken to be so.

    Raises InputError for a name that does not exist.
    """
    return name != CLAIRVOYANT and (is_user_controller(name) or _entry(name).uses_preview)


def _entry(name: str) -> ControllerEntry:
    entry = CONTROLLERS.find(name)
    if entry is None:
        known = ", ".join([*CONTROLLERS.names(), CLAIRVOYANT])
        raise InputError(f"controller must be one of {known} or FILE.py:NAME or FILE.fmu, got {name!r}")
    return entry
