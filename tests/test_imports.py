"""Imports flow one way: between packages, and between the rooms (sub-packages) inside them."""

import ast
import subprocess
import sys
from functools import cache
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

import foreride

ROOT = Path(__file__).resolve().parents[1]

MAY_IMPORT: dict[str, set[str]] = {
    "files": set(),
    "road": set(),
    "comfort": set(),
    "detector": {"road"},
    "vehicle": {"road"},
    "preview": {"road", "detector"},
    "controller": {"preview", "vehicle", "comfort"},
    "scenarios": {"road", "comfort", "detector", "vehicle", "preview", "controller"},
}
TORCH_ROOMS = {"detector.network", "detector.training", "detector.export"}
"""Rooms in which PyTorch may be imported; a drive and an evaluation need none of them."""
TRUE_ROAD = {
    "road.road", "road.features", "road.roughness", "road.ranging", "road.render", "road.summary",
    "road.dataset",
}  # fmt: skip
"""What the estimator may not see: the road as it is."""
MAX_FILES = 15
"""Largest number of files in a room."""


@cache
def imported(path: Path) -> frozenset[str]:
    """Dotted names, relative to `foreride`, of the modules that a file imports, wherever in it."""
    names: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module and node.level == 0:
            names |= {f"{node.module}.{alias.name}" for alias in node.names}
    return frozenset(name.removeprefix("foreride.") for name in names)


@cache
def files_of(package: str) -> tuple[Path, ...]:
    return tuple(sorted((ROOT / package).rglob("*.py")))


def room_of(dotted: str) -> str:
    """The room of a module: its package's sub-package, or the module itself where it stands at the root."""
    return ".".join(dotted.split(".")[:2])


def inside(name: str, places: set[str]) -> bool:
    return any(f"{name}.".startswith(f"{place}.") for place in places)


@pytest.mark.parametrize("package", MAY_IMPORT)
def test_imports_between_packages_flow_one_way(package: str) -> None:
    allowed = MAY_IMPORT[package] | {package, "files"}
    wrong = [
        f"{path.relative_to(ROOT)} imports {name}"
        for path in files_of(package)
        for name in imported(path)
        if name.split(".")[0] in MAY_IMPORT and name.split(".")[0] not in allowed
    ]
    assert files_of(package), f"package {package} has no files"
    assert not wrong


def test_no_package_imports_the_public_interface_that_is_built_on_it() -> None:
    interface = {path.stem for path in (ROOT / "foreride").glob("*.py")} | set(foreride.__all__)
    wrong = [
        f"{path.relative_to(ROOT)} imports {name}"
        for package in MAY_IMPORT
        for path in files_of(package)
        for name in imported(path)
        if name.split(".")[0] in interface
    ]
    assert not wrong


def test_imports_between_rooms_form_no_circle() -> None:
    graph: dict[str, set[str]] = {}
    for package in MAY_IMPORT:
        for path in files_of(package):
            dotted = ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")
            targets = {room_of(name) for name in imported(path) if name.split(".")[0] in MAY_IMPORT}
            graph.setdefault(room_of(dotted), set()).update(targets - {room_of(dotted)})
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        pytest.fail(f"circle: {' -> '.join(error.args[1])}")


def test_every_file_of_the_packages_imports_by_the_public_name() -> None:
    wrong = [
        f"{path.relative_to(ROOT)}:{node.lineno}"
        for package in MAY_IMPORT
        for path in files_of(package)
        for node in ast.walk(ast.parse(path.read_text()))
        if (
            isinstance(node, ast.ImportFrom)
            and (node.level or (node.module or "").split(".")[0] in MAY_IMPORT)
        )
        or (isinstance(node, ast.Import) and any(a.name.split(".")[0] in MAY_IMPORT for a in node.names))
    ]
    assert not wrong


def test_rooms_are_small() -> None:
    rooms = {path.parent for package in MAY_IMPORT for path in files_of(package)}
    crowded = {str(room.relative_to(ROOT)): len(list(room.glob("*.py"))) for room in rooms}
    assert {room: count for room, count in crowded.items() if count > MAX_FILES} == {}


def test_the_estimator_does_not_see_the_true_road() -> None:
    seen = {name for path in files_of("preview") for name in imported(path) if inside(name, TRUE_ROAD)}
    assert not seen


def test_preview_takes_only_detections_and_calibration_from_the_detector() -> None:
    taken = {name for path in files_of("preview") for name in imported(path) if inside(name, {"detector"})}
    assert all(inside(name, {"detector.detections", "detector.calibration"}) for name in taken)


def test_detector_takes_only_the_obstacle_classes_from_the_road() -> None:
    taken = {name for path in files_of("detector") for name in imported(path) if inside(name, {"road"})}
    assert all(inside(name, {"road.obstacle_classes"}) for name in taken)


CLASS_FILES = {"road/obstacle_classes.py", "detector/calibration.py", "preview/obstacle_classes.py"}
"""What a new obstacle class needs an entry in; everything else reads them."""


def test_obstacle_classes_are_named_in_their_tables_alone() -> None:
    naming = {
        str(path.relative_to(ROOT))
        for package in MAY_IMPORT
        for path in files_of(package)
        for node in ast.walk(ast.parse(path.read_text()))
        if isinstance(node, ast.Constant) and node.value == "speed_bump"
    }
    assert naming == CLASS_FILES


def test_no_package_below_the_scenarios_needs_them_in_its_tests() -> None:
    below = [package for package in MAY_IMPORT if package != "scenarios"]
    wrong = [
        f"{path.relative_to(ROOT)} imports {name}"
        for package in below
        for path in files_of(f"tests/{package}")
        for name in imported(path)
        if inside(name, {"scenarios", "benchmarks"})
    ]
    assert not wrong


def test_layers_and_objects_of_the_renderer_know_nothing_of_the_renderer() -> None:
    shared = {"road.render.appearance", "road.render.map_tile", "road.render.noise"}
    for room in ("road.render.paint", "road.render.objects"):
        for path in (ROOT / room.replace(".", "/")).glob("*.py"):
            used = {name for name in imported(path) if inside(name, {"road.render"})}
            assert all(inside(name, shared | {room}) for name in used), path


def test_torch_only_in_the_rooms_that_train_and_export() -> None:
    users = {
        room_of(".".join(path.relative_to(ROOT).with_suffix("").parts))
        for package in MAY_IMPORT
        for path in files_of(package)
        if any(name.split(".")[0] == "torch" for name in imported(path))
    }
    assert users
    assert users <= TORCH_ROOMS


def test_everything_a_scenario_needs_imports_without_torch() -> None:
    code = (
        "import sys, importlib.abc\n"
        "class NoTorch(importlib.abc.MetaPathFinder):\n"
        "    def find_spec(self, name, path, target=None):\n"
        "        if name.split('.')[0] == 'torch': raise ImportError('torch is not to be imported')\n"
        "sys.meta_path.insert(0, NoTorch())\n"
        "import foreride.scenarios.cli, foreride.scenarios.simulation.simulate, foreride.road.render.scene\n"
        "import foreride.detector.evaluation.evaluate, foreride.detector.runtime"
    )
    result = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True)
    assert result.returncode == 0, result.stderr
