"""User-defined controllers: loaded from `path/to/file.py:name`, with guarded calls."""

import inspect
from collections.abc import Callable
from copy import deepcopy
from pathlib import Path
from typing import Any, TypeGuard

import numpy as np

from foreride.controller.command_limits import command_limits
from foreride.controller.fmu_controller import is_fmu_controller, load_fmu_controller
from foreride.controller.interface import BaseController, Controller, Estimate, Timing
from foreride.files.errors import InputError, printable, shortened, shown
from foreride.files.own_code import error_text, load, location, say_once, waiting_for
from foreride.preview.road_preview import RoadPreview
from foreride.vehicle.load import Car
from foreride.vehicle.plant.sensors import Measurement

Factory = Callable[..., Controller]
"""(vehicle, timing, **settings) → controller."""


def is_user_controller(name: str) -> bool:
    """Whether a controller name refers to a file."""
    return ":" in name or is_fmu_controller(name)


def check_user_controller(target: str, vehicle: Car, timing: Timing) -> None:
    """Load the file that a name refers to, without a drive. Raises InputError if it does not load or fit."""
    if is_fmu_controller(target):
        load_fmu_controller(target, vehicle, timing)
    else:
        load_user_controller(target)


def load_user_controller(target: str) -> Factory:
    """Load the class or function that `path/to/file.py:name` names.

    It is called as name(vehicle, timing, **settings) and returns an object with `reset()` and
    `step(estimate, preview)`. Raises InputError, in one line, if file or name are missing or do not load.
    """
    path, name = _parts(target)
    if path.suffix != ".py" or not path.is_file():
        raise InputError(f"controller {target}: {str(path)!r} must be an existing .py file")
    factory = getattr(load(path, f"controller {target}"), name, None)
    if not callable(factory):
        raise InputError(f"controller {target}: {path} must define a class or function called {name!r}")
    return factory


def build_user_controller(
    target: str | Controller | Factory, vehicle: Car, settings: dict[str, float], timing: Timing
) -> "UserController":
    """Build the controller that `path/to/file.py:name` or an FMU names, or a class, function or object gives.

    Raises InputError if that fails.
    """
    if isinstance(target, str) and is_fmu_controller(target):
        file = target.partition(":")[0]
        return UserController(load_fmu_controller(target, vehicle, timing), Path(file), "FMU", vehicle)
    source = target if isinstance(target, str) else f"{_file_of(target)}:{controller_label(target)}"
    path, name = _parts(source)
    given = load_user_controller(target) if isinstance(target, str) else target
    try:
        with waiting_for(f"controller {source}"):
            controller: Any = given(vehicle, timing, **settings) if _is_factory(given) else given
            missing = [part for part in ("reset", "step") if not callable(getattr(controller, part, None))]
    except (InputError, KeyboardInterrupt):
        raise
    except BaseException as error:  # user code may raise anything, even SystemExit
        raise InputError(f"controller {source}: cannot be built ({error_text(error, path)})") from error
    if missing:
        raise InputError(f"controller {source}: must have reset() and step(), lacks {', '.join(missing)}")
    return UserController(controller, path, name, vehicle)


def controller_label(controller: str | Controller | Factory) -> str:
    """Name of a controller in results: its own, or that of its class or function."""
    if isinstance(controller, str):
        return controller
    return str(getattr(controller, "__name__", type(controller).__name__))


def _is_factory(given: Any) -> TypeGuard[Factory]:
    return callable(given) and (isinstance(given, type) or not hasattr(given, "step"))


def _file_of(given: Any) -> str:
    """File in which a controller's class or function is defined."""
    try:
        return inspect.getfile(given if _is_factory(given) else type(given))
    except (TypeError, OSError):  # typed in at a prompt
        return "<input>"


def _parts(target: str) -> tuple[Path, str]:
    path, _, name = target.rpartition(":")
    return Path(path), name


class UserController(BaseController):
    """Wrapper of a user-defined controller that treats its failures like those of a solver.

    problem: reason why the last step gave no answer, with file and line, or None. The first time, the whole
    message is printed on stderr. Ctrl-C passes. `step` receives copies, so that user code cannot change the
    loop's data. What the user's
    controller lacks beside `reset` and `step` has the defaults of `BaseController`.
    """

    def __init__(self, controller: Controller, path: Path, name: str, vehicle: Car) -> None:
        self._controller, self._path, self._name = controller, path, name
        self._zeros = np.zeros(len(command_limits(vehicle)[0]))
        self._shapes = sorted({(vehicle.wheels,), self._zeros.shape})
        self._acted_problem: str | None = None

    def reset(self) -> None:
        """Reset the user's controller. Raises InputError if its `reset` fails."""
        self.problem, self.active, self._acted_problem = None, (), None
        try:
            self._controller.reset()
        except KeyboardInterrupt:
            raise
        except BaseException as error:
            subject = f"controller {self._path}:{self._name}"
            raise InputError(f"{subject}: reset() fails ({error_text(error, self._path)})") from error

    def step(self, estimate: Estimate, preview: RoadPreview | None) -> np.ndarray:
        """Return the user's command (wheels,) or (inputs,); zeros if there is a `problem`."""
        self.problem, self.active = None, ()
        answer = self._guarded(lambda: self._call_step(deepcopy(estimate), deepcopy(preview)))
        self.problem, self._acted_problem = self.problem or self._acted_problem, None
        return self._zeros if answer is None else answer

    def sensed(self, measurement: Measurement) -> None:
        """Pass the sensors' readings to a controller that has `sensed`; a failure invalidates its answer."""
        self.problem = None
        self._guarded(lambda: self._call_sensed(measurement))
        self._acted_problem = self._acted_problem or self.problem

    def acted(self, command: np.ndarray) -> None:
        """Pass the issued command to a controller that has `acted`; a failure invalidates its next answer."""
        self.problem = None
        self._guarded(lambda: self._call_acted(command.copy()))
        self._acted_problem = self._acted_problem or self.problem

    def _call_acted(self, command: np.ndarray) -> None:
        if (listen := getattr(self._controller, "acted", None)) is not None:
            listen(command)

    def _call_sensed(self, measurement: Measurement) -> None:
        if (listen := getattr(self._controller, "sensed", None)) is not None:
            listen(deepcopy(measurement))

    def _call_step(self, estimate: Estimate, preview: RoadPreview | None) -> np.ndarray | None:
        returned = self._controller.step(estimate, preview)
        answer = _numbers(returned)
        if answer is None or answer.shape not in self._shapes or not np.isfinite(answer).all():
            allowed = " or ".join(str(shape) for shape in self._shapes)
            message = f"finite numbers {allowed} expected, got {shown(returned)}"
            self._blame("bad answer", self._step_line(), message)
            return None
        problem = getattr(self._controller, "problem", None)
        self.problem = None if problem is None else shortened(printable(problem))
        self.active = tuple(str(name) for name in getattr(self._controller, "active", ()))
        return answer

    def _guarded(self, act: Callable[[], Any]) -> Any:
        """Return the result of `act`; record an exception as the problem."""
        try:
            return act()
        except KeyboardInterrupt:
            raise
        except BaseException as error:  # user code may raise anything, even SystemExit
            self._blame(type(error).__name__, location(error, self._path), error_text(error, self._path))
            return None

    def _blame(self, kind: str, location: str, message: str) -> None:
        """Record the problem without step-dependent details, so that repetitions count as one."""
        self.problem, self.active = f"own controller: {kind} at {location}", ()
        subject = f"controller {self._path}:{self._name}: {kind} at {location}"
        say_once(subject, f"{subject}: a fallback acts instead ({message})")

    def _step_line(self) -> str:
        code = getattr(getattr(self._controller.step, "__func__", self._controller.step), "__code__", None)
        return f"{self._path.name}:{code.co_firstlineno}" if code else self._path.name


def _numbers(returned: Any) -> np.ndarray | None:
    """Convert the answer to floats; None for anything else, including text that reads as a number."""
    try:
        answer = np.asarray(returned)
    except ValueError:  # rows of different lengths
        return None
    return answer.astype(float) if answer.dtype.kind in "fiu" else None
