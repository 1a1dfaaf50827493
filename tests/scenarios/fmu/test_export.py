"""Exported FMUs: valid for FMPy, and simulated by it as the native loop."""

import abc
import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from fmpy import read_model_description
from fmpy.validation import validate_fmu
from pythonfmu3.enums import Fmi3Status

import foreride
from foreride.files.errors import InputError
from foreride.scenarios.cases import Case
from foreride.scenarios.fmu.embedded import embed
from foreride.scenarios.fmu.export import export
from foreride.scenarios.fmu.slave_fmi2 import Fmi2BlockSlave
from foreride.scenarios.fmu.slave_fmi3 import Fmi3BlockSlave
from foreride.scenarios.fmu.vehicle_block import VehicleBlock
from foreride.scenarios.simulation.simulate import simulate

SHORT = {"start_m": 38.0, "road.length_m": 50.0}
VERSIONS = ["2.0", "3.0"]


@pytest.fixture(scope="module")
def case() -> Case:
    return Case(foreride.load_scenario("bump_8x40_30", SHORT), "skyhook", "oracle", 1)


@pytest.fixture(scope="module")
def folder(case: Case, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """All parts in both versions."""
    found = tmp_path_factory.mktemp("fmu")
    for version in VERSIONS:
        for part in ("vehicle", "controller", "loop"):
            preview = {"ahead_m": 1.0, "step_m": 0.05} if part == "controller" else None
            export(found / f"{part}_{version}.fmu", part, case, version, preview)
    return found


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("part", ["vehicle", "controller", "loop"])
def test_validation_finds_nothing(folder: Path, part: str, version: str) -> None:
    assert validate_fmu(str(folder / f"{part}_{version}.fmu")) == []


@pytest.mark.parametrize("version", VERSIONS)
def test_description_states_units_and_capabilities(folder: Path, version: str) -> None:
    description = read_model_description(str(folder / f"vehicle_{version}.fmu"))
    units = {variable.name: variable.unit for variable in description.modelVariables}
    assert units["road_height_0"] == "m"
    assert units["damping_command_1"] == "N·s/m"
    assert units["seat_acc_0"] == "m/s²"
    simulation = description.coSimulation
    assert simulation.canHandleVariableCommunicationStepSize
    assert simulation.canGetAndSetFMUstate
    other = read_model_description(str(folder / f"loop_{version}.fmu")).coSimulation
    assert not other.canGetAndSetFMUstate


def in_fmpy(action: str, scratch: Path, **options: object) -> np.ndarray:
    """Result of an action of `fmpy_process`."""
    given = scratch / "options.json"
    given.write_text(json.dumps(options))
    process = Path(__file__).with_name("fmpy_process.py")
    done = subprocess.run(
        [sys.executable, process, action, given], capture_output=True, text=True, check=False
    )
    assert given.with_suffix(".npy").exists(), done.stderr
    return np.load(given.with_suffix(".npy"))


@pytest.mark.parametrize("version", VERSIONS)
def test_loop_simulated_without_any_option_is_the_native_drive(
    folder: Path, case: Case, version: str, tmp_path: Path
) -> None:
    native = simulate(case).signals
    names = ["heave_m", "rattle_m_0", "command_0"]
    unit = str(folder / f"loop_{version}.fmu")
    rows = in_fmpy("simulated", tmp_path, fmu=unit, output=names, repeats=2)
    ticks = np.rint(rows["time"] * 1000).astype(int)
    assert ticks[-1] >= len(native["heave_m"]) - 10
    ticks = np.minimum(ticks, len(native["heave_m"]) - 1)
    for name in names:
        np.testing.assert_allclose(rows[name], native[name][ticks], rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize("version", VERSIONS)
def test_simulated_car_is_the_native_car(folder: Path, case: Case, version: str, tmp_path: Path) -> None:
    time = np.arange(0.0, 0.301, 0.001)
    names = ["road_height_0", "road_velocity_0", "damping_command_0"]
    signals = np.zeros(len(time), [("time", float), *((name, float) for name in names)])
    signals["time"] = time
    signals["road_velocity_0"] = 0.4 * np.cos(20.0 * time)
    signals["road_height_0"] = 0.02 * np.sin(20.0 * time)
    signals["damping_command_0"] = 700.0
    np.save(tmp_path / "inputs.npy", signals)
    rows = in_fmpy(
        "simulated",
        tmp_path,
        fmu=str(folder / f"vehicle_{version}.fmu"),
        inputs=str(tmp_path / "inputs.npy"),
        stop_time=0.3,
        step_size=0.001,
        output_interval=0.001,
        output=["heave_m", "tyre_force_0", "objective"],
    )
    block, before = VehicleBlock(case.scenario), {}
    for tick, row in enumerate(rows):
        block.inputs |= {name: float(signals[name][tick]) for name in names}
        if tick == 0:
            block.reset()
        else:
            assert row["heave_m"] == pytest.approx(before["heave_m"], rel=1e-9, abs=1e-12)
            assert row["objective"] == pytest.approx(before["objective"], rel=1e-9)
        block.advance(1)
        before = block.outputs()


def test_state_of_the_car_is_set_back(folder: Path, tmp_path: Path) -> None:
    results = in_fmpy(
        "continued", tmp_path, fmu=str(folder / "vehicle_2.0.fmu"), folder=str(tmp_path / "unit")
    )
    assert results[0] == results[1] != 0.0


@pytest.mark.parametrize("kind", [Fmi2BlockSlave, Fmi3BlockSlave])
def test_step_that_is_no_multiple_of_a_tick_fails_with_a_reason(
    case: Case, kind: type, tmp_path: Path
) -> None:
    embed(tmp_path, "vehicle", case, {})
    slave = type("Slave", (kind,), {})(instance_name="one", resources=str(tmp_path))
    assert sys.modules["abc"] is abc  # the module that such a class is said to be of
    answer = slave.do_step(0.0, 0.0015)
    assert answer is False or answer.status is Fmi3Status.error
    assert [entry.msg for entry in slave.log_queue] == [
        "communication step must be a multiple of 0.001 s, got 0.0015 s"
    ]


def test_case_with_files_of_its_own_is_refused(case: Case, tmp_path: Path) -> None:
    own = Case(case.scenario, "own.py:Own", "none", 0)
    with pytest.raises(InputError, match="carries no code"):
        export(tmp_path / "x.fmu", "loop", own, "2.0")
    assert not (tmp_path / "x.fmu").exists()


def test_command_writes_an_fmu_and_names_a_wrong_file(tmp_path: Path) -> None:
    def foreride_(*arguments: str) -> subprocess.CompletedProcess[str]:
        command = [sys.executable, "-m", "foreride.scenarios.cli", "fmu", "export", *arguments]
        return subprocess.run(command, capture_output=True, text=True, cwd=tmp_path, check=False)

    done = foreride_("vehicle", "bump_8x40_30", "--out", "car.fmu", "--fmi", "3.0")
    assert done.returncode == 0, done.stderr
    assert read_model_description(str(tmp_path / "car.fmu")).fmiVersion == "3.0"
    wrong = foreride_("vehicle", "bump_8x40_30", "--out", "car.zip")
    assert wrong.returncode == 2
    assert "must name a file that ends in .fmu" in wrong.stderr
