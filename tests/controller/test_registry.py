from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from foreride.controller.interface import Timing
from foreride.controller.laws.passive import passive
from foreride.controller.laws.skyhook import Skyhook
from foreride.controller.registry import CONTROLLERS, build, uses_preview
from foreride.controller.settings import ControllerSettings
from foreride.controller.user_controller import load_user_controller
from foreride.files.errors import InputError
from foreride.files.reading.strict import structure
from foreride.vehicle.dampers.damper import MrBoucWenDamper, MrTanhDamper
from foreride.vehicle.load import control_model, load_vehicle
from tests.controller.cars import estimate, step_preview

OWN = """
import numpy as np

class Steady:
    def __init__(self, vehicle, timing, damping=1000.0):
        self.damping = np.full(vehicle.wheels, damping)

    def reset(self):
        pass

    def step(self, estimate, preview):
        return self.damping

def broken(vehicle, timing):
    raise RuntimeError("no such luck")

def nothing(vehicle, timing):
    return object()

number = 3
"""


@pytest.fixture
def own(tmp_path: Path) -> Path:
    path = tmp_path / "own.py"
    path.write_text(OWN)
    return path


@pytest.mark.parametrize(
    ("name", "car"),
    [
        (name, car)
        for name in CONTROLLERS.own
        for car in ("quarter", "half", "full")
        if (name, car) != ("mpc_wheelbase", "quarter") and not (name.startswith("mpc") and car == "full")
    ],
)
def test_every_name_builds_a_working_controller(name: str, car: str) -> None:
    vehicle = load_vehicle(car)
    controller = build(name, vehicle, timing=Timing(0.01, 0.005))
    controller.reset()
    command = controller.step(estimate(vehicle), step_preview(0.5, 0.05, vehicle.wheels))
    assert command.shape == (vehicle.wheels,)
    assert np.all((command >= 300.0) & (command <= 4500.0))


def test_a_damper_with_inner_states_is_known_without_them() -> None:
    """As in the closed loop, where controllers get the control model of the car."""
    vehicle = replace(load_vehicle("quarter"), damper=MrBoucWenDamper())
    known = control_model(vehicle)
    for name in ("passive", "skyhook", "mpc_reactive"):
        commands = [build(name, car).step(estimate(known), None) for car in (vehicle, known)]
        np.testing.assert_array_equal(*commands)


def test_only_preview_controllers_see_ahead() -> None:
    assert uses_preview("mpc_preview")
    assert uses_preview("own.py:Steady")
    assert not any(uses_preview(name) for name in ("passive", "skyhook", "mpc_reactive"))


@pytest.mark.parametrize("ask", [lambda name: build(name, load_vehicle("quarter")), uses_preview])
def test_an_unknown_name_is_answered_with_the_known_ones(ask: Callable[[str], object]) -> None:
    with pytest.raises(
        InputError, match=r"^controller must be one of passive, fixed, fixed_best, .*got 'skyhok'$"
    ):
        ask("skyhok")


def test_settings_reach_their_controller() -> None:
    settings = structure(ControllerSettings, {"passive": {"damping_ns_m": 900}}, "test")
    np.testing.assert_array_equal(
        build("passive", load_vehicle("half"), settings).step(None, None),  # type: ignore[arg-type]
        [900.0, 900.0],
    )


def test_a_mistyped_setting_is_refused_with_its_place() -> None:
    with pytest.raises(InputError, match="horizont_s"):
        structure(ControllerSettings, {"mpc": {"horizont_s": 0.2}}, "test")


def test_a_users_own_controller(own: Path) -> None:
    vehicle = load_vehicle("half")
    settings = ControllerSettings(user={"damping": 700.0})
    np.testing.assert_array_equal(
        build(f"{own}:Steady", vehicle, settings).step(estimate(vehicle), None), [700.0, 700.0]
    )


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("Absent", "must define a class or function called 'Absent'"),
        ("number", "must define a class or function called 'number'"),
        ("broken", "cannot be built .RuntimeError: no such luck"),
        ("nothing", r"must have reset\(\) and step\(\), lacks reset, step"),
    ],
)
def test_what_is_wrong_with_an_own_controller_is_told(own: Path, name: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        build(f"{own}:{name}", load_vehicle("quarter"))


def test_wrong_keyword_of_an_own_controller_is_told(own: Path) -> None:
    with pytest.raises(InputError, match="unexpected keyword argument 'gain'"):
        build(f"{own}:Steady", load_vehicle("quarter"), ControllerSettings(user={"gain": 1.0}))


def test_files_that_do_not_load_are_told(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"must be an existing \.py file"):
        load_user_controller(f"{tmp_path}/absent.py:Own")
    bad = tmp_path / "bad.py"
    bad.write_text("def f(:\n")
    with pytest.raises(InputError, match=r"bad\.py does not load .SyntaxError"):
        load_user_controller(f"{bad}:f")


@pytest.mark.parametrize("name", CONTROLLERS.own)
def test_every_controller_reports_on_itself(name: str) -> None:
    """What supervisor, loop and statistics read is declared, not asked for by name."""
    controller = build(name, load_vehicle("half"))
    assert controller.problem is None
    assert controller.active == ()
    assert isinstance(controller.stats, dict)
    controller.acted(np.zeros(2))


def test_a_law_of_coefficients_commands_them_to_an_ideal_damper_as_they_are() -> None:
    car, x = load_vehicle("quarter"), np.array([0.01, 0.3, 0.0, -0.2, 1500.0])
    at, settings = estimate(car, x), ControllerSettings()
    np.testing.assert_array_equal(
        build("skyhook", car, settings).step(at, None), Skyhook(car, settings.skyhook).step(at, None)
    )


def test_a_law_of_settings_commands_them_to_any_damper_as_they_are() -> None:
    car = replace(load_vehicle("quarter"), damper=MrTanhDamper())
    model, settings = control_model(car), ControllerSettings()
    np.testing.assert_array_equal(
        build("passive", car, settings).step(estimate(model), None),
        passive(model, settings.passive).step(estimate(model), None),
    )


def test_which_controllers_see_ahead_command_settings_and_have_settings_of_their_own() -> None:
    entries = CONTROLLERS.own
    assert {name for name, entry in entries.items() if entry.uses_preview} == {"mpc_preview"}
    settings = {"passive", "fixed", "fixed_best", "mpc_reactive", "mpc_wheelbase", "mpc_preview"}
    assert {name for name, entry in entries.items() if entry.commands_settings} == settings
    for name, entry in entries.items():
        assert entry.settings == ("mpc" if name.startswith("mpc") else name)
        assert entry.summary
