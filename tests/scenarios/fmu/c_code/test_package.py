"""Car as an FMU in C: valid for FMPy, its state can be kept, and its sources are enough to build it."""

import subprocess
import zipfile
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
import pytest
from fmpy.fmi2 import FMU2Slave
from fmpy.fmi3 import FMU3Slave
from fmpy.validation import validate_fmu

import foreride
from foreride.files.errors import InputError
from foreride.scenarios.cli import main
from foreride.scenarios.definition.schema import Scenario
from foreride.scenarios.fmu.c_code import package
from foreride.scenarios.fmu.c_code.package import export_c
from foreride.scenarios.fmu.vehicle_block import VehicleBlock

VERSIONS = ["2.0", "3.0"]


@pytest.fixture(scope="module")
def scenario() -> Scenario:
    return foreride.load_scenario("bump_8x40_30", {"vehicle.model": "full"})


@pytest.fixture(scope="module")
def folder(scenario: Scenario, tmp_path_factory: pytest.TempPathFactory) -> Path:
    found = tmp_path_factory.mktemp("c_code")
    for version in VERSIONS:
        assert export_c(found / f"{version}.fmu", scenario, version)
    return found


@pytest.mark.parametrize("version", VERSIONS)
def test_validation_finds_nothing_and_units_are_stated(folder: Path, version: str) -> None:
    path = str(folder / f"{version}.fmu")
    assert validate_fmu(path) == []
    description = fmpy.read_model_description(path)
    variables = {variable.name: variable for variable in description.modelVariables}
    assert variables["seat_acc_0"].unit == "m/s²"
    assert float(variables["damping_command_0"].start) == 1500.0
    assert len(description.initialUnknowns) == len(description.outputs) > 50
    assert description.coSimulation.canHandleVariableCommunicationStepSize
    assert not description.coSimulation.needsExecutionTool


@pytest.mark.parametrize("version", VERSIONS)
def test_fmpy_simulates_the_native_car(
    scenario: Scenario, folder: Path, version: str, tmp_path: Path
) -> None:
    time = np.arange(0.0, 0.301, 0.005)
    names = ["road_height_1", "road_velocity_1", "road_acceleration_1", "damping_command_2", "forward_acc"]
    signals = np.zeros(len(time), [("time", float), *((name, float) for name in names)])
    signals["time"] = time
    signals["road_height_1"] = 0.03 * np.sin(20.0 * time)
    signals["road_velocity_1"] = 0.6 * np.cos(20.0 * time)
    signals["road_acceleration_1"] = -12.0 * np.sin(20.0 * time)
    signals["damping_command_2"] = 700.0
    signals["forward_acc"] = -3.0
    outputs = ["heave_m", "roll_rad", "tyre_force_1", "seat_acc_0", "stop_force_1"]
    rows = fmpy.simulate_fmu(
        str(folder / f"{version}.fmu"),
        input=signals,
        output=outputs,
        stop_time=0.3,
        step_size=0.005,
        output_interval=0.005,
    )
    block, before = VehicleBlock(scenario), {}
    for number, row in enumerate(rows):
        block.inputs |= {name: float(signals[name][number]) for name in names}
        if number == 0:
            block.reset()
        else:
            for name in outputs:
                assert row[name] == pytest.approx(before[name], rel=1e-9, abs=1e-9)
        block.advance(5)
        before = block.outputs()


def started(path: Path, version: str, folder: Path) -> tuple[Any, dict[str, int]]:
    """Instance after initialization, and the value references by name."""
    description = fmpy.read_model_description(str(path))
    given = {"guid": description.guid, "unzipDirectory": fmpy.extract(str(path), unzipdir=str(folder))}
    kind = FMU2Slave if version == "2.0" else FMU3Slave
    unit = kind(modelIdentifier="ForerideVehicle", instanceName="one", **given)
    unit.instantiate()
    unit.enterInitializationMode()
    unit.exitInitializationMode()
    return unit, {variable.name: variable.valueReference for variable in description.modelVariables}


@pytest.mark.parametrize("version", VERSIONS)
def test_state_is_saved_restored_and_serialised(folder: Path, version: str, tmp_path: Path) -> None:
    unit, references = started(folder / f"{version}.fmu", version, tmp_path)
    second = version == "2.0"
    write, read = (unit.setReal, unit.getReal) if second else (unit.setFloat64, unit.getFloat64)
    names = ("getFMUstate", "setFMUstate", "serializeFMUstate", "deSerializeFMUstate")
    if not second:
        names = ("getFMUState", "setFMUState", "serializeFMUState", "deserializeFMUState")
    save, restore, pack, unpack = (getattr(unit, name) for name in names)
    write([references["road_height_0"]], [0.05])
    unit.doStep(0.0, 0.02)
    state = save()
    results = []
    for kept in (state, unpack(pack(state))):
        restore(kept)
        unit.doStep(0.02, 0.04)
        results.append(read([references["heave_m"], references["tyre_force_0"]]))
    assert results[0] == results[1]
    assert results[0][0] != 0.0
    unit.reset()
    unit.enterInitializationMode()
    unit.exitInitializationMode()
    assert read([references["heave_m"]]) == [0.0]
    with pytest.raises(Exception, match="failed with status 3"):
        unit.doStep(0.0, 0.0005)
    with pytest.raises(Exception, match="failed with status 3"):
        write([references["heave_m"]], [1.0])
    unit.freeInstance()


@pytest.mark.parametrize("version", VERSIONS)
def test_sources_compile_alone_without_a_warning(folder: Path, version: str, tmp_path: Path) -> None:
    with zipfile.ZipFile(folder / f"{version}.fmu") as archive:
        archive.extractall(tmp_path)
    compiler = ["cc", "-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-fPIC", "-c", "-o"]
    source = tmp_path / "sources" / f"fmi{version[0]}.c"
    subprocess.run([*compiler, str(tmp_path / "x.o"), str(source)], check=True)


def test_same_car_gives_the_same_file(scenario: Scenario, folder: Path, tmp_path: Path) -> None:
    export_c(tmp_path / "again.fmu", scenario, "2.0")
    assert (tmp_path / "again.fmu").read_bytes() == (folder / "2.0.fmu").read_bytes()


def test_without_a_compiler_the_sources_alone_are_written(
    scenario: Scenario, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(package.shutil, "which", lambda name: None)
    monkeypatch.delenv("CC", raising=False)
    assert not export_c(tmp_path / "car.fmu", scenario, "3.0")
    assert fmpy.supported_platforms(str(tmp_path / "car.fmu")) == ["c-code"]
    monkeypatch.setenv("CC", "nowhere-cc")
    with pytest.raises(InputError, match="C compiler nowhere-cc, which CC names, is not found"):
        export_c(tmp_path / "car.fmu", scenario, "3.0")


def test_command_exports_the_vehicle_alone(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["fmu", "export", "loop", "bump_8x40_30", "--code", "c", "--out", str(tmp_path / "x.fmu")]
    assert main(arguments) == 2
    assert "--code c is for the vehicle" in capsys.readouterr().err
    arguments[2] = "vehicle"
    assert main(arguments) == 0
    assert "in C, sources and a binary" in " ".join(capsys.readouterr().out.split())
