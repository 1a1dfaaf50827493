"""Tests of the built wheel, beside a project whose modules have the names of foreride's packages."""

import json
import shlex
import shutil
import subprocess
import sys
import sysconfig
import tomllib
import venv
import zipfile
from importlib.metadata import version
from pathlib import Path

import pytest
import yaml

import foreride

pytestmark = pytest.mark.slow

ROOT = Path(__file__).resolve().parents[2]
PROJECT_URLS = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["urls"]
PACKAGES = ("comfort", "controller", "detector", "files", "preview", "road", "scenarios", "vehicle")
DATA = {".py", ".yaml", ".json", ".onnx", ".pt", ".html", ".css", ".js", ".typed"}
"""Suffixes of the files that belong to a package."""

PROJECT = {
    **dict.fromkeys(("road/__init__.py", "scenarios/__init__.py", "files/__init__.py"), "MINE = True\n"),
    **dict.fromkeys(("comfort.py", "detector.py", "preview.py"), "MINE = True\n"),
    "vehicle.py": "MINE, DAMPING = True, 900.0\n",
    "controller.py": """
import numpy as np

import vehicle


class Own:
    def __init__(self, car, timing):
        self.command = np.full(car.wheels, vehicle.DAMPING)

    def reset(self):
        pass

    def step(self, estimate, preview):
        return self.command
""",
    "drive.py": """
import comfort, controller, detector, files, preview, road, scenarios, vehicle

import foreride

for module in (comfort, detector, files, preview, road, scenarios, vehicle):
    assert module.MINE
result = foreride.run("short.yaml", controller.Own)
assert result.fallbacks == 0
assert set(result.signals["command_0"][-500:]) == {vehicle.DAMPING}
print(foreride.__file__)
""",
    "test_ride.py": """
import road
import vehicle


def test_ride(ride_comfort):
    assert road.MINE and vehicle.MINE
    assert ride_comfort("short.yaml", "controller.py:Own").metrics["objective"] > 0
""",
    "short.yaml": """
title: A bump
speed_kmh: 40
vehicle: {model: quarter}
road: {length_m: 20, features: [{kind: half_sine_bump, start_m: 10, height_m: 0.05, length_m: 0.4}]}
""",
    "study.yaml": "scenarios: [short.yaml]\ncontrollers: [passive]\nvary: {speed_kmh: {values: [30, 40]}}\n",
}  # fmt: skip

USER = """
from pathlib import Path

import numpy as np

import foreride


class Own:
    def __init__(self, vehicle: object, timing: object) -> None:
        self.command = np.full(2, 900.0)

    def reset(self) -> None: ...

    def step(self, estimate: foreride.Estimate, preview: foreride.RoadPreview | None) -> np.ndarray:
        return self.command


scenario = foreride.load_scenario("bump_8x40_30", {"camera.latency_s": 0.1})
result: foreride.Result = foreride.run(scenario, Own, "oracle", seed=1)
objective: float = result.metrics["objective"]
unit: str = result.units["seat_acc_0"]
peak: float = float(np.abs(result.signals["seat_acc_0"]).max())
saved: Path = foreride.load_run(result.save("out")).report("out.html")
compared: foreride.Comparison = foreride.compare(["hump_flat_30"], ["passive", Own, Own(0, 0)], jobs=2)
names: list[str] = [one.controller for one in compared]
best: float = foreride.bound(scenario).objective
rows: int = foreride.sweep("study.yaml", "swept").num_rows
page: Path = foreride.report(compared, Path("compared.html"))
mass: float = foreride.load_vehicle("half").body_mass_kg
states: int = foreride.linear_twin(foreride.load_vehicle("half")).nstates
length: float = foreride.Road(40.0).length_m
boxes: np.ndarray = foreride.Detector()(np.zeros((480, 640, 3), np.uint8)).boxes
ride = foreride.ride_metrics
controller: foreride.Controller = Own(0, 0)
error: type[ValueError] = foreride.InputError
foreride.register_controller("own", Own)
decorators = foreride.register_damper, foreride.register_feature
others = foreride.register_metric, foreride.register_perception
foreride.register_metric("jerk")  # wrong
foreride.run("bump_8x40_30", controler="passive")  # wrong
foreride.run("bump_8x40_30", seed="1")  # wrong
foreride.compare("bump_8x40_30", jobs="2")  # wrong
result.metric  # wrong
foreride.drive  # wrong
result.signals["seat_acc_0"].meen()  # wrong
"""


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("wheel")
    command = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(folder)]
    subprocess.run(command, cwd=ROOT, check=True, capture_output=True)
    (built,) = folder.glob("*.whl")
    return built


@pytest.fixture(scope="module")
def python(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Interpreter of an environment with the wheel and, from this one, all libraries but this foreride."""
    folder = tmp_path_factory.mktemp("environment")
    venv.create(folder, with_pip=False, symlinks=True)
    (site,) = folder.glob("lib/python*/site-packages")
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(site)
    (site / "libraries.pth").write_text(sysconfig.get_path("purelib"))
    return folder / "bin" / "python"


@pytest.fixture
def project(tmp_path: Path) -> Path:
    for name, text in PROJECT.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(text)
    return tmp_path


def called(python: Path, folder: Path, *arguments: str) -> str:
    """Standard output of a command in the folder."""
    environment = {"PATH": "/usr/bin:/bin", "HOME": str(folder.parent)}
    command = [str(python), *arguments]
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_the_wheel_installs_foreride_alone_with_all_its_data(wheel: Path) -> None:
    names = zipfile.ZipFile(wheel).namelist()
    assert {name.split("/")[0] for name in names} == {"foreride", wheel.name.split("-py3")[0] + ".dist-info"}
    expected = {
        f"foreride/{path.relative_to(ROOT)}"
        for package in PACKAGES
        for path in (ROOT / package).rglob("*")
        if path.suffix in DATA
    }
    assert not expected - set(names)
    for path in (
        "scenarios/library/bump_8x40_30.yaml", "scenarios/baselines/reference.json", "py.typed",
        "vehicle/parameters/half_car.yaml", "scenarios/report/page/page.html",
    ):  # fmt: skip
        assert f"foreride/{path}" in names
    assert any(name.startswith("foreride/detector/weights/") and name.endswith(".onnx") for name in names)
    assert any(name.startswith("foreride/controller/") and name.endswith(".yaml") for name in names)


def test_it_works_beside_a_project_with_modules_of_the_same_names(python: Path, project: Path) -> None:
    cli = ("-m", "foreride.scenarios.cli")
    assert str(python.parents[1]) in called(python, project, "drive.py")
    called(
        python, project, *cli, "run", "short.yaml", "--controllers", "passive,controller.py:Own", "--out", "o"
    )
    assert len(list(project.glob("o/*/metrics.json"))) == 2
    called(python, project, "-m", "pytest", "-q", "-p", "no:cacheprovider", "--ride-accept")
    assert "1 passed" in called(python, project, "-m", "pytest", "-q", "-p", "no:cacheprovider")
    assert "2 of 2 drives" in called(
        python, project, *cli, "sweep", "study.yaml", "--out", "s", "--jobs", "1"
    )


def test_a_checkout_works_without_installation(python: Path, tmp_path: Path) -> None:
    (site,) = python.parents[1].glob("lib/python*/site-packages")
    shutil.move(site / "foreride", tmp_path / "foreride")
    try:
        assert "usage" in called(python, ROOT, "-m", "foreride.detector.training.train", "--help")
        assert str(ROOT) in called(python, ROOT, "-c", "import foreride.road as r; print(r.__file__)")
    finally:
        shutil.move(tmp_path / "foreride", site / "foreride")


def interpreters() -> list[str]:
    """Interpreters of the supported versions that this machine has."""
    versions = [f"3.{minor}" for minor in (11, 12, 13)]
    managed = Path.home() / ".pyenv" / "versions"
    beside = [path for version in versions for path in managed.glob(f"{version}.*/bin/python{version}")]
    on_path = [found for version in versions if (found := shutil.which(f"python{version}"))]
    proper = [found for found in on_path if "shims" not in found]
    return sorted({sys.executable, *proper, *map(str, beside)})


@pytest.mark.parametrize("interpreter", interpreters(), ids=lambda path: Path(path).parents[1].name)
def test_every_supported_version_reads_the_wheel(interpreter: str, wheel: Path, tmp_path: Path) -> None:
    """All modules compile, and what needs no library works: version, help, names of the interface."""
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(tmp_path)
    called(Path(interpreter), tmp_path, "-m", "compileall", "-q", "foreride")
    cli = ("-m", "foreride.scenarios.cli")
    assert called(Path(interpreter), tmp_path, *cli, "--version") == f"foreride {version('foreride')}\n"
    assert "lower bound" in called(Path(interpreter), tmp_path, *cli, "--help")
    called(Path(interpreter), tmp_path, "-c", "import foreride; assert 'run' in foreride.__all__")


def test_the_workflow_of_the_example_passes_in_a_clean_environment(wheel: Path, tmp_path: Path) -> None:
    """Its steps run as they stand; the wheel takes the place of the repository; libraries are borrowed."""
    shutil.copytree(ROOT / "examples" / "regression", project := tmp_path / "project")
    shutil.rmtree(project / "ride_baselines")  # numbers may differ from platform to platform
    venv.create(environment := tmp_path / "environment", with_pip=True, symlinks=True)
    (site,) = environment.glob("lib/python*/site-packages")
    python, command = environment / "bin" / "python", environment / "bin" / "foreride"
    called(python, project, "-m", "pip", "install", "--quiet", "--no-index", "--no-deps", str(wheel))
    (site / "libraries.pth").write_text(sysconfig.get_path("purelib"))
    called(python, project, "-m", "pytest", "-q", "-p", "no:cacheprovider", "--ride-accept")
    cases = ("short_bump.yaml", "--controllers", "passive", "--perception", "none")
    called(command, project, "regress", *cases, "--baseline", "ride.json", "--accept")
    workflow = yaml.safe_load((project / "github_actions.yml").read_text())
    install, *steps = [step["run"] for step in workflow["jobs"]["ride"]["steps"] if "run" in step]
    (address,) = {url for name, url in PROJECT_URLS.items() if name == "Repository"}
    assert install == f'pip install "foreride @ git+{address}" pytest'
    for step in steps:
        program, *arguments = shlex.split(step, comments=True)
        called(environment / "bin" / program if program == "foreride" else python, project,
               *(("-m", program) if program != "foreride" else ()), *arguments)  # fmt: skip
    assert json.loads((project / "ride-diff.json").read_text())["rows"]


def test_a_user_of_the_public_interface_is_checked_by_mypy(python: Path, tmp_path: Path) -> None:
    (tmp_path / "user.py").write_text(USER)
    options = ("--no-error-summary", "--no-incremental", "--check-untyped-defs", "user.py")
    command = [sys.executable, "-m", "mypy", "--python-executable", str(python), *options]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    found = {int(line.split(":")[1]) for line in done.stdout.splitlines() if ": error: " in line}
    wrong = {number for number, line in enumerate(USER.splitlines(), 1) if line.endswith("# wrong")}
    assert found == wrong, done.stdout + done.stderr
    used = {name for name in foreride.__all__ if f"foreride.{name}" in USER}
    assert used == set(foreride.__all__)
