"""Machine code in the cache is that of the present sources, whichever file of them has changed."""

import os
import subprocess
import sys
from collections import namedtuple
from pathlib import Path
from typing import Any
from unittest.mock import Mock

import numpy as np
import pytest

from foreride.files.interpolation import cell
from foreride.files.stamp import stamp
from foreride.vehicle import equations

ROOT = Path(__file__).resolve().parents[2]
SOURCES = {
    "constant": "FACTOR, TABLE = 2.0, (3.0, 4.0)\n",
    "inner": "from constant import FACTOR\nfrom foreride.files.jit import njit\n\n"
    "@njit\ndef doubled(x):\n    return FACTOR * x\n",
    "outer": "import numpy as np\nfrom constant import TABLE\nfrom foreride.files.jit import njit\n"
    "from inner import doubled\n\n"
    "@njit\ndef own(x):\n    return doubled(x) + TABLE[1]\n\n"
    "@njit('f8(f8)')\ndef asked(x):\n    return own(x)\n",
}
CALL = (
    "import outer\nprint(outer.asked(1.0))\n"
    "print(sum(outer.asked.stats.cache_hits.values()), file=__import__('sys').stderr)"
)


def _answer(folder: Path, cache: str | None = None) -> tuple[float, bool]:
    """What the outer function returns in a new process, and whether it came from the cache."""
    environment = os.environ | {"PYTHONPATH": os.pathsep.join([str(folder), str(ROOT)])}
    environment.pop("NUMBA_CACHE_DIR", None)
    environment |= {"NUMBA_CACHE_DIR": cache} if cache else {}
    done = subprocess.run(
        [sys.executable, "-B", "-c", CALL], env=environment, capture_output=True, text=True, check=True
    )
    return float(done.stdout), done.stderr.split()[-1] == "1"


def _edit(folder: Path, name: str, old: str, new: str) -> None:
    source = folder / f"{name}.py"
    source.write_text(source.read_text().replace(old, new))


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name, text in SOURCES.items():
        (tmp_path / f"{name}.py").write_text(text)
    return tmp_path


def test_a_change_in_any_source_reaches_the_caller(folder: Path) -> None:
    assert _answer(folder) == (6.0, False)
    assert _answer(folder) == (6.0, True)
    _edit(folder, "inner", "FACTOR * x", "FACTOR * x + 10")
    assert _answer(folder) == (16.0, False)
    _edit(folder, "constant", "2.0, (3.0, 4.0)", "2.5, (3.0, 5.0)")
    assert _answer(folder) == (17.5, False)


def test_a_change_reaches_the_caller_with_a_cache_elsewhere(folder: Path) -> None:
    cache = str(folder / "cache")
    assert _answer(folder, cache) == (6.0, False)
    assert list((folder / "cache").rglob("*.nbi"))
    _edit(folder, "inner", "FACTOR * x", "FACTOR * x + 10")
    assert _answer(folder, cache) == (16.0, False)


def test_the_stamp_tells_constants_and_functions_of_other_modules_alone() -> None:
    own = {"__name__": "own", "own": Mock(py_func=Mock(__module__="own")), "np": np, "Path": Path}
    assert stamp(own) == stamp({"__name__": "own"})
    changed: list[dict[str, Any]] = [
        {"A": 1}, {"A": 1.0}, {"A": (1, 2)}, {"A": np.zeros(2)}, {"A": np.zeros(3)}, {"A": equations},
        {"A": Mock(py_func=cell.py_func)}, {"A": namedtuple("A", "x")}, {"A": namedtuple("A", "y")},
    ]  # fmt: skip
    assert len({stamp(own | one) for one in changed} | {stamp(own)}) == len(changed) + 1
