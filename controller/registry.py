"""Registry of controllers by name; user-defined ones are in `controller.own`."""

from collections.abc import Callable
from functools import partial
from typing import NamedTuple

from controller.base import Controller, Timing
from controller.damper_inverse import Inverted, is_linear
from controller.hybrid import Hybrid
from controller.lqr_clipped import ClippedLqr
from controller.mpc import PredictiveController
from controller.own import build_own, is_own
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
    """Build the controller called `name`, or a user-defined one named as `path/to/file.py:name`.

    Without settings it is tuned as shipped for the vehicle's kind. It is given the vehicle's control model
    (`prediction_car`), without the internal states of its dampers.
    Raises InputError for an unknown name and for settings that do not fit the vehicle.
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
    if is_own(name):
        return build_own(name, vehicle, settings.user, timing)
    entry = _entry(name)
    law = entry.make(vehicle, getattr(settings, entry.settings) if entry.settings else None, timing)
    return law if entry.knows_damper or is_linear(vehicle) else Inverted(law, vehicle)


def sees_ahead(name: str) -> bool:
    """Whether the controller called `name` uses a preview; of the user's own that is taken to be so.

    Raises InputError for a name that does not exist.
    """
    return name != CLAIRVOYANT and (is_own(name) or _entry(name).sees_ahead)


def _entry(name: str) -> Entry:
    if name not in CONTROLLERS:
        known = ", ".join([*CONTROLLERS, CLAIRVOYANT])
        raise InputError(f"controller must be one of {known} or FILE.py:NAME, got {name!r}")
    return CONTROLLERS[name]
