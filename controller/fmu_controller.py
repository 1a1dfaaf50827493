"""Controller of another tool as an FMU: sensor readings, estimate and preview in, commands out."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

import numpy as np
from annotated_types import Interval

from foreride.controller.interface import Estimate, Timing
from foreride.files.errors import InputError
from foreride.files.fmi.foreign import ForeignFmu, Quantity
from foreride.files.own_code import say_once
from foreride.files.reading import strict
from foreride.files.reading.ranges import Checked
from foreride.preview.road_preview import RoadPreview
from foreride.vehicle.equations import input_size, motion, rattle
from foreride.vehicle.load import Car
from foreride.vehicle.plant.sensors import Measurement
from foreride.vehicle.state import signal_unit

_MOST_POINTS = 5000
_READINGS = ("body_acc", "wheel_acc", "rattle_m")
_VEHICLE = ("pitch_rate", "speed_m_s", "roll_rate")
_HEAVE = "estimated_heave_velocity"
_ESTIMATES = {
    "estimated_body_velocity": "m/s",
    "estimated_wheel_velocity": "m/s",
    "estimated_rattle_m": "m",
    "estimated_rattle_velocity": "m/s",
    "estimated_road_height": "m",
}


@dataclass(frozen=True)
class FmuControllerMap(Checked):
    """Map of a controller FMU, a YAML file.

    map: its variable for each quantity of ours that it calls by another name. behind_m, step_m: beginning,
    behind each wheel, and spacing of its grid of previewed heights. answers_after_step: its outputs follow
    from the inputs only after a step; otherwise they do at once, as FMI expects of a direct feedthrough.
    """

    map: dict[str, str] = field(default_factory=dict)
    behind_m: Annotated[float, Interval(ge=0.0, le=50.0), "m"] = 0.5
    step_m: Annotated[float, Interval(ge=0.01, le=0.5), "m"] = 0.05
    answers_after_step: bool = False


def is_fmu_controller(name: str) -> bool:
    """Whether a controller name refers to an FMU: `FILE.fmu` or `FILE.fmu:MAP.yaml`."""
    return name.partition(":")[0].endswith(".fmu")


def load_fmu_controller(name: str, vehicle: Car, timing: Timing) -> "FmuController":
    """Controller for a car from `FILE.fmu` or `FILE.fmu:MAP.yaml`. Raises InputError if it does not fit."""
    path, _, map_file = name.partition(":")
    table = strict.read(FmuControllerMap, map_file) if map_file else FmuControllerMap()
    return FmuController(Path(path), table, vehicle, timing)


class FmuController:
    """Controller in an FMU, which advances by one communication step per decision.

    problem: that a step has failed, after which a fallback acts for the rest of the drive; None before.
    """

    problem: str | None = None

    def __init__(self, path: Path, table: FmuControllerMap, vehicle: Car, timing: Timing) -> None:
        """Connect the FMU's inputs to what the loop offers, and its outputs to the commands."""
        self._vehicle, self._period_s, self._table = vehicle, timing.period_s, table
        quantities = _quantities(vehicle, table.map)
        self._unit = ForeignFmu(path, "controller", quantities, table.map)
        self._unit.check_step(timing.period_s)
        if not self._unit.inputs:
            raise InputError(
                f"controller {path}: none of its inputs is a quantity of the loop; map names them"
            )
        self._points = sum(name.startswith("preview_height_0_") for name in self._unit.inputs)
        self._begun = False
        self._reading: Measurement | None = None

    def reset(self) -> None:
        """Begin anew at the next decision."""
        self._begun, self.problem, self._reading = False, None, None

    def sensed(self, measurement: Measurement) -> None:
        """Receive the readings of the sensors, which come before the decision of the same time."""
        self._reading = measurement

    def step(self, estimate: Estimate, preview: RoadPreview | None) -> np.ndarray:
        """Return the commands of the FMU; zeros if there is a `problem`."""
        if self.problem is None:
            try:
                return self._command(estimate, preview)
            except InputError as error:
                self.problem = "own controller: a step of its FMU failed"
                say_once(str(error), f"{error}; a fallback acts instead")
        return np.zeros(len(self._unit.outputs))

    def _command(self, estimate: Estimate, preview: RoadPreview | None) -> np.ndarray:
        offered = self._offered(estimate, preview)
        inputs = np.array([offered[name] for name in self._unit.inputs])
        if not self._begun:
            self._unit.start(inputs)
            self._begun = True
        seen = inputs[None] if self._table.answers_after_step else None
        return self._unit.advance(self._period_s, inputs[None], seen)[0]

    def _offered(self, estimate: Estimate, preview: RoadPreview | None) -> dict[str, float]:
        offered = self._estimated(estimate) | self._previewed(preview)
        reading = self._reading
        for name in _READINGS:
            values = getattr(reading, name) if reading else np.zeros(self._vehicle.wheels)
            offered |= {f"{name}_{wheel}": float(value) for wheel, value in enumerate(values)}
        return offered | {name: float(getattr(reading, name)) if reading else 0.0 for name in _VEHICLE}

    def _estimated(self, estimate: Estimate) -> dict[str, float]:
        state, (travel, rate) = motion(self._vehicle, estimate.x), rattle(self._vehicle, estimate.x)
        wheel_velocity = np.array(state.wheel_velocity)
        rows = {
            "estimated_body_velocity": rate + wheel_velocity,
            "estimated_wheel_velocity": wheel_velocity,
            "estimated_rattle_m": travel,
            "estimated_rattle_velocity": rate,
            "estimated_road_height": estimate.road_height,
        }
        found = {f"{name}_{i}": float(value) for name, row in rows.items() for i, value in enumerate(row)}
        return found | {_HEAVE: float(state.body_velocity[0])}

    def _previewed(self, preview: RoadPreview | None) -> dict[str, float]:
        wheels = range(self._vehicle.wheels)
        heights = np.zeros((self._vehicle.wheels, self._points))
        sigma = {"preview_height_sigma": 0.0, "preview_position_sigma": 0.0}
        if preview is not None and self._points:
            first = round(self._table.behind_m / self._table.step_m)
            grid = (np.arange(self._points) - first) * self._table.step_m
            expected = preview.height_m * preview.existence
            heights = np.array([np.interp(grid, preview.distance_m, expected[wheel]) for wheel in wheels])
            sigma["preview_height_sigma"] = float(preview.height_sigma_m.max())
            sigma["preview_position_sigma"] = float(preview.position_sigma_m.max())
        names = {f"preview_height_{i}_{k}": float(h) for i in wheels for k, h in enumerate(heights[i])}
        return names | sigma | {"preview_valid": float(preview is not None)}


def _quantities(vehicle: Car, names: Mapping[str, str]) -> list[Quantity]:
    """All that the loop offers, and the commands."""
    wheels, forces = range(vehicle.wheels), range(input_size(vehicle) - vehicle.wheels)
    offered: list[tuple[str, str]] = []
    for name in _READINGS:
        offered += [(f"{name}_{i}", signal_unit(name)) for i in wheels]
    offered += [(name, signal_unit(name)) for name in _VEHICLE]
    offered += [
        (_HEAVE, "m/s"),
        *((f"{name}_{i}", unit) for name, unit in _ESTIMATES.items() for i in wheels),
    ]
    offered += [("preview_valid", "1"), ("preview_height_sigma", "m"), ("preview_position_sigma", "m")]
    offered += [(f"preview_height_{i}_{k}", "m") for i in wheels for k in range(_MOST_POINTS // len(wheels))]
    commands: list[tuple[str, str, bool]] = [(f"damping_command_{i}", "N·s/m", True) for i in wheels]
    commands += [(f"force_command_{i}", "N", True) for i in forces]
    return [
        *(Quantity(name, unit, "input") for name, unit in offered),
        *(Quantity(name, unit, "output", needed) for name, unit, needed in commands),
    ]
