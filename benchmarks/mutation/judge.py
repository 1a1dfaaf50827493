"""Run of tests on one mutant in a process forked from one that holds the heavy libraries.

The mutated file stands in a copy of the repository; the checkout is never written.
"""

import importlib
import os
import resource
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path

import pytest

from benchmarks.mutation.machine_code import copy_code

LIBRARIES = ("numpy", "scipy.signal", "scipy.optimize", "casadi", "mujoco", "numba", "hypothesis")
WALL_RATIO = 10
"""Limit of a child's wall time over that of its processor time, for one that sleeps or a busy machine."""


class _Selection:
    """Pytest plugin that runs the named tests alone, in their order."""

    def __init__(self, names: Sequence[str]) -> None:
        self._rank = {name: rank for rank, name in enumerate(names)}

    def pytest_collection_modifyitems(self, items: list[pytest.Item]) -> None:
        """Choose and order."""
        items[:] = sorted(
            [item for item in items if item.nodeid in self._rank], key=lambda item: self._rank[item.nodeid]
        )


def copied(root: Path, folder: Path) -> Path:
    """Copy of the files that git tracks, with their machine code."""
    listing = subprocess.run(["git", "ls-files", "-z"], cwd=root, check=True, capture_output=True, text=True)
    for name in filter(None, listing.stdout.split("\0")):
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(root / name, folder / name)
    copy_code(root, folder)
    return folder


def preload() -> None:
    """Import the libraries that every test imports, once for all mutants."""
    for name in LIBRARIES:
        importlib.import_module(name)


def verdict(folder: Path, tests: Sequence[str], limit_s: float, compiled: bool = True) -> str:
    """`killed` where a test fails, `timeout` beyond the limit, `survived` where all pass.

    tests: names in pytest, in the order in which they run.
    limit_s: of the processor's time.
    compiled: whether Numba compiles, otherwise its functions run as they are written.
    """
    files = list(dict.fromkeys(name.split("::")[0] for name in tests))
    code = in_child(folder, files, limit_s, compiled, _Selection(tests))
    return "timeout" if code < 0 else "survived" if code == 0 else "killed"


def in_child(
    folder: Path,
    files: Sequence[str],
    limit_s: float,
    compiled: bool,
    plugin: object,
    after: Callable[[], None] = lambda: None,
) -> int:
    """Exit code of pytest with a plugin in a child, which calls `after` at its end; -1 past the limit."""
    child = os.fork()
    if child == 0:
        os.setsid()
        resource.setrlimit(resource.RLIMIT_CPU, (int(limit_s) + 1, int(limit_s) + 1))
        code = _run(folder, files, compiled, plugin)
        after()
        os._exit(code)
    end = time.monotonic() + WALL_RATIO * limit_s
    while time.monotonic() < end:
        done, status = os.waitpid(child, os.WNOHANG)
        if done:
            return max(-1, os.waitstatus_to_exitcode(status))
        time.sleep(0.02)
    os.killpg(child, signal.SIGKILL)
    os.waitpid(child, 0)
    return -1


def _run(folder: Path, files: Sequence[str], compiled: bool, plugin: object) -> int:
    """Exit code of pytest in the copy, without its output."""
    import numba

    numba.config.DISABLE_JIT = not compiled  # type: ignore[attr-defined]

    for name in [name for name in sys.modules if name.split(".")[0] in ("foreride", "benchmarks")]:
        del sys.modules[name]  # the checkout's; the copy's are imported in their place
    os.chdir(folder)
    sys.path.insert(0, str(folder))
    os.environ |= {"PYTHONPATH": str(folder), "HYPOTHESIS_PROFILE": "mutation"}
    silent = os.open(os.devnull, os.O_WRONLY)
    os.dup2(silent, 1)
    os.dup2(silent, 2)
    first = ["-x"] if isinstance(plugin, _Selection) else []
    try:
        return int(pytest.main([*first, "-p", "no:cacheprovider", *files], plugins=[plugin]))
    except BaseException:
        return 1
