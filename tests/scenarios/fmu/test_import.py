"""FMUs of other tools in the loop: a foreign car and controller, and ours taken back in."""

import json
import zipfile
from collections.abc import Callable
from pathlib import Path

import pytest

import foreride
from foreride.files.errors import InputError
from foreride.scenarios.cases import Case
from foreride.scenarios.cli import main
from foreride.scenarios.fmu.c_code.package import export_c
from foreride.scenarios.fmu.export import export
from foreride.scenarios.runs.read import read
from foreride.scenarios.simulation.simulate import DriveFailed, Run, simulate
from tests.scenarios.fmu import foreign_car, foreign_controller

SHORT = {"start_m": 38.0, "road.length_m": 48.0}
QUARTER = SHORT | {"vehicle.model": "quarter"}


@pytest.fixture(autouse=True)
def _allowed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("FORERIDE_ALLOW_FMU", "1")


def drive(fields: dict, controller: str = "skyhook", perception: str = "none") -> Run:
    return simulate(Case(foreride.load_scenario("bump_8x40_30", fields), controller, perception, 1))


def foreign(path: Path, **fields: object) -> dict:
    return QUARTER | {"vehicle.fmu": str(path), "vehicle.map": foreign_car.MAP} | fields


def assert_same_metrics(run: Run, native: Run, relative: float) -> None:
    assert run.metrics.keys() == native.metrics.keys()
    for name, value in native.metrics.items():
        assert run.metrics[name] == pytest.approx(value, rel=relative, abs=1e-12), name


def test_own_car_taken_back_in_is_the_native_drive(tmp_path: Path) -> None:
    scenario = foreride.load_scenario("bump_8x40_30", SHORT)
    export(tmp_path / "car.fmu", "vehicle", Case(scenario, "passive", "none", 0), "2.0")
    native = drive(SHORT)
    again = drive(SHORT | {"vehicle.fmu": str(tmp_path / "car.fmu")})
    assert_same_metrics(again, native, 1e-9)
    assert again.files_sha256["vehicle_fmu_sha256"] is not None


BRAKING = {"vehicle.model": "full", "speed": [{"at_s": 0.5, "kmh": 30.0}, {"at_s": 1.0, "kmh": 20.0}]}


@pytest.mark.parametrize(
    ("version", "fields"),
    [("2.0", BRAKING), ("3.0", {"vehicle.parameters.actuator": {"kind": "fully_active"}})],
)
def test_own_car_in_c_is_the_native_drive(version: str, fields: dict, tmp_path: Path) -> None:
    fields = SHORT | fields
    assert export_c(tmp_path / "car.fmu", foreride.load_scenario("bump_8x40_30", fields), version)
    assert_same_metrics(drive(fields | {"vehicle.fmu": str(tmp_path / "car.fmu")}), drive(fields), 1e-9)


def test_own_car_in_c_with_another_integrator_agrees(tmp_path: Path) -> None:
    fields = QUARTER | {"vehicle.parameters.damper": {"kind": "mr_bouc_wen"}}
    export_c(tmp_path / "car.fmu", foreride.load_scenario("bump_8x40_30", fields), "3.0")
    assert_same_metrics(drive(fields | {"vehicle.fmu": str(tmp_path / "car.fmu")}), drive(fields), 0.005)


def test_own_controller_taken_back_in_is_the_native_drive(tmp_path: Path) -> None:
    scenario = foreride.load_scenario("bump_8x40_30", SHORT)
    out, preview = tmp_path / "controller.fmu", {"ahead_m": 10.0, "step_m": 0.025}
    export(out, "controller", Case(scenario, "mpc_preview", "oracle", 1), "2.0", preview)
    (tmp_path / "map.yaml").write_text("step_m: 0.025\n")
    again = drive(SHORT, f"{out}:{tmp_path / 'map.yaml'}", "oracle")
    assert_same_metrics(again, drive(SHORT, "mpc_preview", "oracle"), 1e-9)
    assert again.solver["fallbacks"] == 0


def test_foreign_car_in_other_names_and_units(tmp_path: Path) -> None:
    native, run = drive(QUARTER, "passive"), drive(foreign(foreign_car.build(tmp_path)), "passive")
    for name in ("wk_rms", "tyre_load_rms", "rattle_rms", "objective"):
        assert run.metrics[name] == pytest.approx(native.metrics[name], rel=0.02), name


MISBEHAVIOUR: dict[str, tuple[str, str]] = {
    "Failing": ("if self.steps > 400: return False", "fmi2DoStep failed"),
    "Crashing": ("if self.steps > 400: os.kill(os.getpid(), 11)", "was ended by SIGSEGV"),
    "Leaving": ("if self.steps > 400: os._exit(3)", "ended with status 3"),
    "Diverging": ("if self.steps > 400: self.x[0] = float('nan')", "heave_m is not a finite number"),
}


@pytest.mark.parametrize("name", MISBEHAVIOUR)
def test_failed_step_ends_the_drive_and_what_was_driven_is_kept(name: str, tmp_path: Path) -> None:
    statement, reason = MISBEHAVIOUR[name]
    car = foreign_car.build(tmp_path, name, statement)
    with pytest.raises(DriveFailed, match=reason) as failure:
        drive(foreign(car), "passive")
    run = failure.value.run
    assert reason in str(run.failed)
    if name in ("Failing", "Diverging"):  # a process that has gone takes the steps of its last answer with it
        assert run.signals["time_s"][-1] == pytest.approx(0.4)
        assert abs(run.signals["heave_m"][-1]) < 1.0


def test_failed_drive_is_written_and_marked(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    car = foreign_car.build(tmp_path, "Stopping", "if self.steps > 500: return False")
    fields = [f"vehicle.map.{name}={value}" for name, value in foreign_car.MAP.items()]
    fields += [f"vehicle.fmu={car}", "vehicle.model=quarter", "start_m=38.0", "road.length_m=48.0"]
    options = [option for field in fields for option in ("--set", field)]
    status = main(
        [
            "run",
            "bump_8x40_30",
            "--controllers",
            "passive",
            "--allow-fmu",
            *options,
            "--out",
            str(tmp_path / "out"),
        ]
    )
    captured = capsys.readouterr()
    assert status == 2
    assert captured.err.strip().count("\n") == 0
    assert "what was driven until then is in" in captured.err
    (folder,) = (path.parent for path in (tmp_path / "out").rglob("manifest.json"))
    manifest = json.loads((folder / "manifest.json").read_text())
    assert "Stopping.fmu: fmi2DoStep failed" in manifest["failed"]
    assert str(tmp_path) not in json.dumps(manifest)
    assert any("failed" in note for note in manifest["notes"])
    run = read(folder)
    assert run.signals["time_s"][-1] == pytest.approx(0.5)
    assert run.failed == manifest["failed"]


def test_foreign_controller_acts_as_the_same_law_in_python(tmp_path: Path) -> None:
    (tmp_path / "law.py").write_text(foreign_controller.LAW)
    python = drive(QUARTER, f"{tmp_path / 'law.py'}:Skyhook")
    run = drive(QUARTER, foreign_controller.build(tmp_path, "Hook", 10**6))
    assert run.metrics == python.metrics
    assert run.solver["fallbacks"] == 0


def test_failed_step_of_a_controller_gives_way_to_the_fallback(tmp_path: Path) -> None:
    run = drive(QUARTER, foreign_controller.build(tmp_path, "Tired", 20))
    assert len(run.signals["time_s"]) == run.case.scenario.ticks + 1
    assert run.solver["solves"] == 20
    assert run.solver["fallbacks"] == len(range(0, run.case.scenario.ticks, 5)) - 20
    assert run.solver["reasons"] == {"own controller: a step of its FMU failed": run.solver["fallbacks"]}


def test_step_that_does_not_divide_the_loops_is_refused(tmp_path: Path) -> None:
    car = foreign_car.build(tmp_path, "Coarse", step_s=0.004)
    with pytest.raises(InputError, match=r"fixed step of 0.004 s does not divide the loop's step of 0.001 s"):
        drive(foreign(car))


def test_car_of_another_platform_is_refused(tmp_path: Path) -> None:
    original = foreign_car.build(tmp_path)
    other = tmp_path / "other.fmu"
    with zipfile.ZipFile(original) as source, zipfile.ZipFile(other, "w") as target:
        for name in source.namelist():
            if not name.startswith("binaries/") or name.endswith("/win64/Quarter.dll"):
                target.writestr(name, source.read(name))
    with pytest.raises(InputError, match="is not for this platform"):
        drive(foreign(other))


DAMAGE: dict[str, tuple[Callable[[bytes], bytes], str]] = {
    "empty": (lambda data: b"", "zip"),
    "cut": (lambda data: data[: len(data) // 2], "zip"),
    "text": (lambda data: b"road_height_0: 1\n", "zip"),
}


@pytest.mark.parametrize("name", DAMAGE)
def test_file_that_is_no_fmu_is_refused(name: str, tmp_path: Path) -> None:
    damage, reason = DAMAGE[name]
    path = tmp_path / "car.fmu"
    path.write_bytes(damage(foreign_car.build(tmp_path).read_bytes()))
    with pytest.raises(InputError, match=f"vehicle.fmu .*car.fmu: .*{reason}"):
        drive(foreign(path))


def test_fmu_of_a_scenario_runs_only_with_permission(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("FORERIDE_ALLOW_FMU")
    with pytest.raises(InputError, match="runs only with --allow-fmu"):
        foreride.load_scenario("bump_8x40_30", QUARTER | {"vehicle.fmu": "car.fmu"})


def test_scenario_with_an_fmu_is_refused_where_the_equations_are_needed(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="plant must leave the car as it is"):
        foreride.load_scenario("bump_8x40_30", foreign(tmp_path / "car.fmu") | {"plant.spring_ratio": 1.1})
    loaded = foreride.load_scenario("bump_8x40_30", foreign(tmp_path / "car.fmu"))
    with pytest.raises(InputError, match="the bound needs the car's equations"):
        foreride.bound(loaded)
    with pytest.raises(InputError, match="carries no other one"):
        export(tmp_path / "out.fmu", "vehicle", Case(loaded, "passive", "none", 0), "2.0")
    with pytest.raises(InputError, match="carries no other one"):
        export_c(tmp_path / "out.fmu", loaded, "2.0")


def test_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"none.fmu: cannot be read"):
        drive(foreign(tmp_path / "none.fmu"))
    with pytest.raises(InputError, match=r"none.fmu: cannot be read"):
        drive(QUARTER, str(tmp_path / "none.fmu"))
