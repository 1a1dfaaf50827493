"""Decoding of files in a process of its own, for decoders in native code that damaged files may crash.

Run as a program with the arguments MODULE FILE TARGET, this module calls `decode` of MODULE with the path and
the content of FILE, and writes the arrays that it gives to TARGET.
"""

import importlib
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from foreride.files.errors import InputError, shortened
from foreride.files.reading.regular_file import read_bytes, reading

PATIENCE_S, BYTES_PER_S = 20.0, 2e6
"""Time for any file, and rate at which larger ones must at least be decoded."""
ROOM = "foreride.road.io.readers."
_MEMORY = 16 << 30
_REFUSED = 2


def decoded(module: str, path: Path, limit: int) -> dict[str, NDArray[np.generic]]:
    """Arrays by name that `decode` of the module gives; InputError also if it crashes or takes too long."""
    size = len(read_bytes(path, limit))
    with tempfile.TemporaryDirectory() as folder:
        target = Path(folder) / "arrays.npz"
        program = [sys.executable, "-m", "foreride.road.io.readers.isolated"]
        command = [*program, f"{ROOM}{module}", str(path), str(target)]
        environment = os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
        try:
            child = subprocess.run(
                command, env=environment, capture_output=True, timeout=PATIENCE_S + size / BYTES_PER_S
            )
        except subprocess.TimeoutExpired:
            raise InputError(f"{path}: cannot be decoded in reasonable time; the file is damaged") from None
        if child.returncode == _REFUSED:
            raise InputError(child.stderr.decode("utf-8", "replace"))
        if child.returncode != 0 or not target.exists():
            raise InputError(f"{path}: cannot be decoded, its decoder crashed; the file is damaged")
        with reading(path), np.load(target) as arrays:
            return dict(arrays)


def main(module: str, file: str, target: str) -> int:
    """Decode in this process; 2 with the message on stderr for bad input."""
    try:
        _bound_memory()
        path = Path(file)
        with reading(path):
            arrays = importlib.import_module(module).decode(path, path.read_bytes())
            np.savez(target, **{shortened(name, 60): values for name, values in arrays.items()})
    except InputError as error:
        sys.stderr.write(str(error))
        return _REFUSED
    return 0


def _bound_memory() -> None:
    try:
        import resource
    except ImportError:  # not on Windows
        return
    resource.setrlimit(resource.RLIMIT_AS, (_MEMORY, _MEMORY))


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
