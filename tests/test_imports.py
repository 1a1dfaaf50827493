"""The packages form a house with one-way doors: who may import whom."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]

MAY_IMPORT: dict[str, set[str]] = {
    "files": set(),
    "road": set(),
    "comfort": set(),
    "detector": set(),
    "vehicle": {"road"},
    "preview": {"road", "detector"},
    "controller": {"preview", "vehicle", "comfort"},
    "scenarios": {"road", "comfort", "detector", "vehicle", "preview", "controller"},
}
TORCH_FREE = {"__init__", "detection", "evaluate", "metrics", "nms", "runtime"}
"""Files of the detector that a scenario or an evaluation needs; the rest trains, and may use torch."""


def imported_modules(path: Path) -> set[str]:
    """Dotted names of all modules that a file imports, wherever in the file the import stands."""
    names: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module and node.level == 0:
            names.add(node.module)
    return {name.removeprefix("foreride.") for name in names}


def files_of(package: str) -> list[Path]:
    return sorted((ROOT / package).rglob("*.py"))


@pytest.mark.parametrize("package", MAY_IMPORT)
def test_imports_flow_one_way(package: str) -> None:
    allowed = MAY_IMPORT[package] | {package, "files"}
    wrong = [
        f"{path.relative_to(ROOT)} imports {name}"
        for path in files_of(package)
        for name in imported_modules(path)
        if name.split(".")[0] in MAY_IMPORT and name.split(".")[0] not in allowed
    ]
    assert files_of(package), f"package {package} has no files"
    assert not wrong


def test_preview_takes_only_the_detection_type_from_the_detector() -> None:
    taken = {
        name
        for path in files_of("preview")
        for name in imported_modules(path)
        if name.split(".")[0] == "detector"
    }
    assert taken <= {"detector.detection"}


def test_torch_only_where_the_detector_is_trained() -> None:
    users = {
        str(path.relative_to(ROOT))
        for package in MAY_IMPORT
        for path in files_of(package)
        if any(name.split(".")[0] == "torch" for name in imported_modules(path))
    }
    assert all(user.startswith("detector/") for user in users)
    assert not users & {f"detector/{name}.py" for name in TORCH_FREE}


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
