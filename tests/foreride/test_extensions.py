"""Tests of an installed package with one part of every sort, which foreride does not know."""

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

import foreride.extensions as ext
from foreride.comfort.registry import METRICS
from foreride.controller.registry import CONTROLLERS
from foreride.files.errors import InputError
from foreride.road.features.feature import FEATURES
from foreride.scenarios.perceptions.registry import PERCEPTIONS
from foreride.vehicle.dampers.damper import DAMPERS
from tests.foreride import sample_parts

ENTRIES = {
    "dampers": "maxwell = sample_parts:Maxwell",
    "features": "ridge = sample_parts:Ridge",
    "perceptions": "lidar = sample_parts:Lidar",
    "controllers": "level = sample_parts:Level",
    "metrics": "jerk_rms = sample_parts:JERK",
}
SCENARIO = """title: Ridge
speed_kmh: 30
road: {length_m: 20, features: [{kind: ridge, start_m: 10, height_m: 0.06}]}
vehicle: {model: quarter, parameters: {damper: {kind: maxwell, spring_n_m: 150000}}}
control: {settings: {user: {level: 900}}}
"""


def install(folder: Path, package: str, entries: dict[str, str]) -> None:
    """Lay out the metadata of an installed package."""
    info = folder / f"{package}-1.0.dist-info"
    info.mkdir(parents=True)
    (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {package}\nVersion: 1.0\n")
    text = "".join(f"[foreride.{group}]\n{lines}\n" for group, lines in entries.items())
    (info / "entry_points.txt").write_text(text)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Folder with the scenario and the installed sample package."""
    install(tmp_path / "site", "sample_parts", ENTRIES)
    shutil.copy(sample_parts.__file__, tmp_path / "site")
    (tmp_path / "ridge.yaml").write_text(SCENARIO)
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([*filter(None, sys.path), str(tmp_path / "site")]))
    monkeypatch.chdir(tmp_path)
    return tmp_path


def foreride(*arguments: str, status: int = 0) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "foreride.scenarios.cli", *arguments]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == status, done.stderr
    return done


@pytest.mark.slow
def test_every_part_reaches_table_json_report_and_regress(folder: Path) -> None:
    choice = ("--controllers", "passive,level,mpc_preview", "--perception", "lidar,boxes")
    done = foreride("compare", "ridge.yaml", *choice, "--jobs", "2", "--json", "c.json", "--out", "runs")
    assert not done.stderr
    assert all(word in done.stdout for word in ("jerk", "m/s³", "level", "lidar"))
    rows = json.loads((folder / "c.json").read_text())["rows"]
    jerk = {(row["controller"], row["perception"]): row["metrics"]["jerk_rms"] for row in rows}
    assert len(jerk) == 5
    assert jerk["mpc_preview", "lidar"] < jerk["level", "lidar"] < jerk["passive", "none"]
    metrics = [json.loads(path.read_text()) for path in (folder / "runs").rglob("metrics.json")]
    assert {one["jerk_rms"] for one in metrics} == set(jerk.values())
    manifest = json.loads(next((folder / "runs").glob("*level*lidar*/manifest.json")).read_text())
    assert manifest["definition"]["vehicle"]["parameters"]["damper"]["kind"] == "maxwell"
    assert manifest["definition"]["road"]["features"][0]["kind"] == "ridge"
    foreride("report", "runs", "--no-render")
    page = (folder / "runs" / "report.html").read_text()
    assert all(word in page for word in ("jerk", ">level<", "lidar"))

    case = ("ridge.yaml", "--controllers", "level", "--perception", "lidar")
    foreride("regress", *case, "--baseline", "b.json", "--accept")
    assert "1 hold" in foreride("regress", "--baseline", "b.json").stdout
    baseline = json.loads((folder / "b.json").read_text())
    baseline["cases"][0]["metrics"]["jerk_rms"] -= 5.0
    (folder / "b.json").write_text(json.dumps(baseline))
    changed = foreride("regress", "--baseline", "b.json", status=1).stdout
    assert "worse   jerk_rms" in changed
    assert "m/s³ (+5" in changed


@pytest.mark.slow
def test_a_feature_is_listed_drawn_and_seen(folder: Path) -> None:
    assert "ridge" in foreride("road", "ridge.yaml").stdout
    foreride("render", "ridge.yaml", "--every", "8", "--out", "images", "--json", "r.json")
    images = json.loads((folder / "r.json").read_text())
    assert [len(image["boxes"]) for image in images.values()] == [1, 0, 0]


@pytest.mark.slow
def test_a_package_that_does_not_load_stops_only_what_needs_it(folder: Path) -> None:
    (folder / "site" / "broken.py").write_text("raise RuntimeError('no licence')\n")
    install(folder / "site", "broken", {"metrics": "cost = broken:COST", "dampers": "foam = broken:Foam"})
    done = foreride("run", "ridge.yaml", "--controllers", "level", "--perception", "none")
    told = "metric cost of broken 1.0: does not load (RuntimeError: no licence at broken.py:1)"
    assert done.stderr == f"foreride: {told}; it is left out\n"
    foam = ("--set", "vehicle.parameters.damper={kind: foam}")
    error = foreride("run", "ridge.yaml", *foam, status=2).stderr
    assert len(error.splitlines()) == 1
    assert "damper.kind damper foam of broken 1.0: does not load (RuntimeError: no licence" in error


@pytest.fixture
def _unregistered() -> Iterator[None]:
    yield
    DAMPERS.unregister("maxwell")
    FEATURES.unregister("ridge")
    PERCEPTIONS.unregister("lidar")
    CONTROLLERS.unregister("level")
    METRICS.unregister("jerk_rms")


@pytest.mark.usefixtures("_unregistered")
def test_parts_are_registered_by_calls() -> None:
    for replace in (False, True):
        ext.register_damper(sample_parts.Maxwell, replace=replace)
        ext.register_feature(sample_parts.Ridge, replace=replace)
        ext.register_perception("lidar", sample_parts.Lidar, replace=replace)
        ext.register_controller("level", sample_parts.Level, replace=replace)
        ext.register_metric(sample_parts.JERK, replace=replace)
    for register in (
        lambda: ext.register_damper(sample_parts.Maxwell),
        lambda: ext.register_controller("skyhook", sample_parts.Level),
        lambda: ext.register_perception("oracle", sample_parts.Lidar),
        lambda: ext.register_metric(sample_parts.JERK),
    ):
        with pytest.raises(InputError, match="the name is taken by"):
            register()


@pytest.mark.parametrize(
    ("register", "told"),
    [
        (lambda: ext.register_damper(sample_parts.Ridge), "damper 'ridge': must be a dataclass derived from"),
        (lambda: ext.register_feature(3), "feature '': the name must be a Python identifier"),
        (lambda: ext.register_perception("lidar", 3), "perception 'lidar': must be a class, a function or"),
        (
            lambda: ext.register_controller("level", 3),
            "controller 'level': must be a class or function, got 3",
        ),
        (lambda: ext.register_metric(3), "metric '': the name must be a Python identifier"),
    ],
)
def test_what_is_no_part_is_refused_in_one_line(register: object, told: str) -> None:
    assert callable(register)
    with pytest.raises(InputError, match=f"^{told}"):
        register()
