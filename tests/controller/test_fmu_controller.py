"""Controller given as an FMU, with a stand-in: its inputs, the time of its answers, and failures."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from foreride.controller import fmu_controller
from foreride.controller.fmu_controller import FmuController, FmuControllerMap, is_fmu_controller
from foreride.controller.interface import Estimate, Timing
from foreride.files.errors import InputError
from foreride.files.fmi.foreign import Quantity
from foreride.preview.road_preview import RoadPreview, distance_grid
from foreride.vehicle.dampers.actuator import SlowActive
from foreride.vehicle.equations import rattle, rest_state
from foreride.vehicle.load import Car
from foreride.vehicle.plant.sensors import Measurement
from foreride.vehicle.state_layout import state_layout
from tests.controller.cars import estimate
from tests.vehicle.plant.short_drives import HALF

TIMING = Timing(0.01, 0.005)
POINTS = 30


class StandIn:
    """FMU that takes all that is offered, of the preview `POINTS` heights a wheel, and answers 1, 2, ..."""

    taken: str = ""
    fails: bool = False

    def __init__(self, path: Path, subject: str, quantities: list[Quantity], names: dict[str, str]) -> None:
        def is_taken(name: str) -> bool:
            previewed = name.startswith("preview_height_") and name[-1].isdigit()
            return name.startswith(self.taken) and not (previewed and int(name.split("_")[-1]) >= POINTS)

        self.quantities = quantities
        self.inputs = [one.name for one in quantities if one.causality == "input" and is_taken(one.name)]
        self.outputs = [one.name for one in quantities if one.causality == "output"]
        self.started: list[np.ndarray] = []
        self.steps: list[tuple[float, np.ndarray, np.ndarray | None]] = []

    def check_step(self, step_s: float) -> None:
        assert step_s == TIMING.period_s

    def start(self, inputs: np.ndarray) -> None:
        self.started.append(inputs)

    def advance(self, step_s: float, before: np.ndarray, after: np.ndarray | None) -> np.ndarray:
        if self.fails:
            raise InputError("the FMU fails")
        self.steps.append((step_s, before, after))
        return np.array([1.0 + np.arange(len(self.outputs))])


@pytest.fixture(autouse=True)
def _stand_in(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(fmu_controller, "ForeignFmu", StandIn)


def controller(car: Car = HALF, table: FmuControllerMap | None = None) -> tuple[FmuController, StandIn]:
    built = FmuController(Path("own.fmu"), table or FmuControllerMap(), car, TIMING)
    unit = built._unit
    assert isinstance(unit, StandIn)
    return built, unit


def moving() -> Estimate:
    x, layout = rest_state(HALF), state_layout(HALF)
    x[layout.body], x[layout.body_velocity] = (0.01, 0.002), (0.3, -0.1)
    x[layout.wheel], x[layout.wheel_velocity] = (0.02, -0.01), (0.5, -0.4)
    return replace(estimate(HALF, x), road_height=np.array([0.03, -0.02]))


def sloping() -> RoadPreview:
    """Half real: the expected height is 1 % of the distance at the front wheel, 2 % at the rear."""
    grid = distance_grid(0.5, 5.0)
    ones = np.ones((2, len(grid)))
    rise = np.stack([0.02 * grid, 0.04 * grid])
    return RoadPreview(0.0, grid, rise, 0.07 * ones, 0.003 * ones * np.array([[1.0], [2.0]]), 0.5 * ones)


def seen(unit: StandIn) -> dict[str, float]:
    return dict(zip(unit.inputs, unit.steps[-1][1][0], strict=True))


def test_it_gets_readings_estimate_and_expected_heights_of_the_preview() -> None:
    built, unit = controller()
    built.sensed(
        Measurement(
            0.0,
            np.array([1.0, 2.0]),
            np.array([3.0, 4.0]),
            np.array([0.05, -0.06]),
            pitch_rate=0.7,
            speed_m_s=12.0,
        )
    )
    np.testing.assert_array_equal(built.step(moving(), sloping()), [1.0, 2.0])
    inputs = seen(unit)
    for name, values in (("body_acc", (1.0, 2.0)), ("wheel_acc", (3.0, 4.0)), ("rattle_m", (0.05, -0.06))):
        assert [inputs[f"{name}_{wheel}"] for wheel in (0, 1)] == list(values)
    assert (inputs["pitch_rate"], inputs["speed_m_s"], inputs["roll_rate"]) == (0.7, 12.0, 0.0)
    travel, rate = rattle(HALF, moving().x)
    body = [0.3 + 0.1 * place for place in HALF.axle_x_m]  # v - x · pitch rate
    for name, values in (
        ("body_velocity", body), ("wheel_velocity", (0.5, -0.4)), ("rattle_m", travel),
        ("rattle_velocity", rate), ("road_height", (0.03, -0.02)),
    ):  # fmt: skip
        assert [inputs[f"estimated_{name}_{wheel}"] for wheel in (0, 1)] == pytest.approx(list(values))
    assert inputs["estimated_heave_velocity"] == 0.3
    grid = -0.5 + 0.05 * np.arange(POINTS)
    for wheel, slope in enumerate((0.01, 0.02)):
        heights = [inputs[f"preview_height_{wheel}_{k}"] for k in range(POINTS)]
        np.testing.assert_allclose(heights, slope * grid, atol=1e-12)
    assert inputs["preview_height_sigma"] == pytest.approx(0.006)
    assert (inputs["preview_position_sigma"], inputs["preview_valid"]) == (pytest.approx(0.07), 1.0)


def test_without_readings_and_preview_it_gets_zeros() -> None:
    built, unit = controller()
    built.step(estimate(HALF), None)
    assert not any(value for name, value in seen(unit).items())


@pytest.mark.parametrize("after_step", [False, True])
def test_it_begins_once_and_answers_to_the_inputs_of_its_step_or_of_the_one_before(after_step: bool) -> None:
    built, unit = controller(table=FmuControllerMap(answers_after_step=after_step))
    for _ in range(3):
        built.step(moving(), None)
    assert len(unit.started) == 1
    np.testing.assert_array_equal(unit.started[0], unit.steps[0][1][0])
    for step_s, _, after in unit.steps:
        assert step_s == TIMING.period_s
        assert (after is not None) == after_step
    built.sensed(Measurement(0.0, np.ones(2), np.ones(2), np.ones(2), pitch_rate=1.0, speed_m_s=1.0))
    built.reset()
    built.step(estimate(HALF), None)
    assert len(unit.started) == 2
    assert seen(unit)["body_acc_0"] == 0.0


def test_a_failed_step_is_a_problem_for_the_rest_of_the_drive(monkeypatch: pytest.MonkeyPatch) -> None:
    built, _ = controller()
    monkeypatch.setattr(StandIn, "fails", True)
    np.testing.assert_array_equal(built.step(moving(), None), [0.0, 0.0])
    assert built.problem == "own controller: a step of its FMU failed"
    monkeypatch.setattr(StandIn, "fails", False)
    np.testing.assert_array_equal(built.step(moving(), None), [0.0, 0.0])
    built.reset()
    assert built.problem is None
    np.testing.assert_array_equal(built.step(moving(), None), [1.0, 2.0])


def test_a_car_with_actuators_takes_their_forces_too() -> None:
    _, unit = controller(replace(HALF, actuator=SlowActive()))
    commands = {one.name: (one.unit, one.required) for one in unit.quantities if one.causality == "output"}
    damping, force = ("N·s/m", True), ("N", True)
    assert commands == {
        "damping_command_0": damping, "damping_command_1": damping,
        "force_command_0": force, "force_command_1": force,
    }  # fmt: skip
    previewed = [one for one in unit.quantities if one.name.startswith("preview_height_1_")]
    assert len(previewed) == 2500


def test_an_fmu_that_takes_nothing_of_the_loop_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(StandIn, "taken", "none")
    with pytest.raises(InputError, match="none of its inputs is a quantity of the loop"):
        controller()


def test_names_of_controller_fmus_may_carry_a_map() -> None:
    assert is_fmu_controller("a/own.fmu")
    assert is_fmu_controller("own.fmu:names.yaml")
    assert not is_fmu_controller("own.py:Own.fmu")
