"""Run of the tests on one mutant in a process forked from one that holds the heavy libraries.

The mutated file stands in a copy of the repository; the checkout is never written.
"""

import importlib
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from pathlib import Path

from benchmarks.mutation.machine_code import copy_code

LIBRARIES = ("numpy", "scipy.signal", "scipy.optimize", "casadi", "mujoco", "numba", "pytest", "hypothesis")


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

    compiled: whether Numba compiles, otherwise its functions run as they are written.
    """
    child = os.fork()
    if child == 0:
        os.setsid()
        os._exit(_run(folder, tests, compiled))
    end = time.monotonic() + limit_s
    while time.monotonic() < end:
        done, status = os.waitpid(child, os.WNOHANG)
        if done:
            return "survived" if os.waitstatus_to_exitcode(status) == 0 else "killed"
        time.sleep(0.05)
    os.killpg(child, signal.SIGKILL)
    os.waitpid(child, 0)
    return "timeout"


def _run(folder: Path, tests: Sequence[str], compiled: bool) -> int:
    """Exit code of pytest in the copy, without its output."""
    import numba
    import pytest

    numba.config.DISABLE_JIT = not compiled  # type: ignore[attr-defined]

    for name in [name for name in sys.modules if name.split(".")[0] in ("foreride", "benchmarks")]:
        del sys.modules[name]  # the checkout's; the copy's are imported in their place
    os.chdir(folder)
    sys.path.insert(0, str(folder))
    os.environ |= {"PYTHONPATH": str(folder), "HYPOTHESIS_PROFILE": "mutation"}
    silent = os.open(os.devnull, os.O_WRONLY)
    os.dup2(silent, 1)
    os.dup2(silent, 2)
    try:
        return int(pytest.main(["-x", "-p", "no:cacheprovider", *tests]))
    except BaseException:
        return 1
