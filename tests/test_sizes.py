"""Tests that files, rooms and functions of the packages stay small."""

import ast
from functools import cache
from pathlib import Path
from statistics import mean, median

ROOT = Path(__file__).resolve().parents[1]
PACKAGES = (
    "comfort", "controller", "detector", "files", "foreride", "preview", "road", "scenarios", "vehicle",
)  # fmt: skip
MAX_MEDIAN_FILE, MAX_FILE = 120, 300
"""Lines of a file."""
MAX_MEAN_FUNCTION, MAX_FUNCTION = 12.0, 60
"""Lines of a function with its signature and docstring."""
MAX_ROOM = 15
"""Files in a folder."""

FUNCTIONS = (ast.FunctionDef, ast.AsyncFunctionDef)


@cache
def lines_of_files() -> dict[str, int]:
    paths = [path for package in PACKAGES for path in sorted((ROOT / package).rglob("*.py"))]
    return {str(path.relative_to(ROOT)): len(path.read_text().splitlines()) for path in paths}


@cache
def lines_of_functions() -> dict[str, int]:
    return {
        f"{name}:{node.lineno} {node.name}": (node.end_lineno or node.lineno) - node.lineno + 1
        for name in lines_of_files()
        for node in ast.walk(ast.parse((ROOT / name).read_text()))
        if isinstance(node, FUNCTIONS)
    }


def test_files_are_short() -> None:
    lines = lines_of_files()
    assert {name: count for name, count in lines.items() if count > MAX_FILE} == {}
    written = [count for name, count in lines.items() if not name.endswith("__init__.py")]
    assert len(written) > 300
    assert median(written) <= MAX_MEDIAN_FILE


def test_files_of_tests_and_benchmarks_are_short() -> None:
    paths = [path for folder in ("tests", "benchmarks", "examples") for path in (ROOT / folder).rglob("*.py")]
    long = {str(path.relative_to(ROOT)): len(path.read_text().splitlines()) for path in paths}
    assert {name: count for name, count in long.items() if count > MAX_FILE} == {}


def test_functions_are_short() -> None:
    lines = lines_of_functions()
    assert {name: count for name, count in lines.items() if count > MAX_FUNCTION} == {}
    assert len(lines) > 1500
    assert mean(lines.values()) <= MAX_MEAN_FUNCTION


def test_rooms_are_small() -> None:
    rooms: dict[str, int] = {}
    for name in lines_of_files():
        rooms[str(Path(name).parent)] = rooms.get(str(Path(name).parent), 0) + 1
    assert {room: count for room, count in rooms.items() if count > MAX_ROOM} == {}
