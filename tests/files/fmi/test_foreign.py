"""Connection of a foreign FMU's variables: each fault of its description is named with what is near."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from foreride.files.errors import InputError
from foreride.files.fmi import foreign
from foreride.files.fmi.foreign import FmuFailed, ForeignFmu, Quantity

WANTED = [
    Quantity("road", "m", "input", True),
    Quantity("speed", "m/s", "input"),
    Quantity("heave", "m", "output", True),
]


def variable(reference: int, causality: str, **changed: Any) -> dict:
    plain = {"type": "Real", "array": False, "unit": None}
    return {"reference": reference, "causality": causality} | plain | changed


def description(**changed: Any) -> dict:
    variables = {
        "Road_z": variable(0, "input"),
        "heave": variable(1, "output"),
        "brake": variable(2, "input"),
    }
    told = {"version": "2.0", "cosimulation": True, "step_s": None, "variables": variables}
    return told | {"platforms": ["here"], "platform": "here"} | changed


class Process:
    """Stands for the process of an FMU: doubles the first input."""

    told: dict
    reason: str | None = None

    def __init__(self, subject: str) -> None:
        self.folder = "folder"

    def ask(self, name: str, *arguments: Any) -> Any:
        if name == "describe":
            return self.told
        if name == "start":
            return [2.0 * arguments[3][0]]
        return [[2.0 * row[0]] for row in arguments[1]], self.reason

    def close(self) -> None:
        pass


@pytest.fixture
def unit(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Any:
    path = tmp_path / "car.fmu"
    path.write_bytes(b"one")
    monkeypatch.setattr(foreign, "FmuProcess", Process)
    monkeypatch.setattr(Process, "reason", None)

    def build(names: dict | None = None, **changed: Any) -> ForeignFmu:
        monkeypatch.setattr(Process, "told", description(**changed), raising=False)
        return ForeignFmu(path, "vehicle.fmu", WANTED, {"road": "Road_z"} if names is None else names)

    return build


def test_values_are_converted_both_ways(unit: Any) -> None:
    millimetres, kilo = ("mm", {"m": 1}, 1e-3), ("km", {"m": 1}, 1e3, 5.0)
    variables = {"Road_z": variable(0, "input", unit=millimetres), "heave": variable(1, "local", unit=kilo)}
    built = unit(variables=variables)
    assert (built.inputs, built.outputs) == (["road"], ["heave"])
    assert built.start(np.array([0.5]))[0] == pytest.approx(2.0 * 500.0 * 1e3 + 5.0)
    assert built.advance(0.001, np.array([[0.0], [1.0]]))[:, 0] == pytest.approx([5.0, 2e6 + 5.0])


REFUSED: dict[str, tuple[dict, str]] = {
    "missing": ({"names": {"road": "Road_y"}}, r"has no variable 'Road_y' for road; did you mean Road_z\?"),
    "unnamed": ({"names": {}}, r"has no variable 'road'"),
    "unknown": ({"names": {"raod": "Road_z", "road": "Road_z"}}, r"map.raod is no quantity .* mean road\?"),
    "direction": ({"names": {"road": "heave"}}, "variable 'heave' must be input, it is output"),
    "version": ({"version": "1.0"}, "must be for co-simulation in FMI 2.0 or 3.0, got FMI 1.0"),
    "exchange": ({"cosimulation": False}, "without co-simulation"),
    "platform": ({"platforms": ["win32"]}, "not for this platform, here; it has binaries for win32"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_fmu_that_does_not_fit_is_refused(unit: Any, name: str) -> None:
    changed, message = REFUSED[name]
    with pytest.raises(InputError, match=message) as refusal:
        unit(**changed)
    assert str(refusal.value).startswith("vehicle.fmu ")


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"type": "Integer"}, "must be a single Real or Float64, it is of type Integer"),
        ({"array": True}, "it is an array"),
        ({"unit": ("kg", {"kg": 1}, 1.0, 0.0)}, "has the unit kg, which cannot be converted to m"),
    ],
)
def test_variable_that_does_not_fit_is_refused(unit: Any, changed: dict, message: str) -> None:
    variables = {"Road_z": variable(0, "input", **changed), "heave": variable(1, "output")}
    with pytest.raises(InputError, match=message):
        unit(variables=variables)


@pytest.mark.parametrize("own_s", [0.002, 0.0003, 0.0, -1.0])
def test_own_step_must_divide_the_loops(unit: Any, own_s: float) -> None:
    unit(step_s=0.00025).check_step(0.001)
    with pytest.raises(InputError, match=r"does not divide the loop's step of 0.001 s"):
        unit(step_s=own_s).check_step(0.001)


def test_failed_step_keeps_those_before_it(unit: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    built = unit()
    built.start(np.zeros(1))
    with pytest.raises(FmuFailed, match="heave is not a finite number") as failure:
        built.advance(0.001, np.array([[1.0], [np.nan], [1.0]]))
    assert failure.value.outputs.tolist() == [[2.0]]
    monkeypatch.setattr(Process, "reason", "out of range")
    with pytest.raises(FmuFailed, match=r"car.fmu: out of range") as failure:
        built.advance(0.001, np.array([[1.0], [3.0]]))
    assert failure.value.outputs.tolist() == [[2.0], [6.0]]


def test_inputs_that_nothing_drives_are_told(unit: Any, capsys: pytest.CaptureFixture[str]) -> None:
    unit()
    assert "inputs that nothing drives keep their start values: brake" in capsys.readouterr().err
