"""Decoding of files in a process of its own, for decoders in native code that damaged files may crash.

Run as a program with the arguments MODULE FILE, this module calls `decode` of MODULE with the path and the
content of FILE, and writes the arrays that it gives to its standard output.
"""

import importlib
import io
import os
import subprocess
import sys
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
    command = [sys.executable, "-m", "foreride.road.io.readers.isolated", f"{ROOM}{module}", str(path)]
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    try:
        patience_s = PATIENCE_S + size / BYTES_PER_S
        child = subprocess.run(command, env=environment, capture_output=True, timeout=patience_s)
    except subprocess.TimeoutExpired:
        raise InputError(f"{path}: cannot be decoded in reasonable time; the file is damaged") from None
    if child.returncode == _REFUSED:
        raise InputError(child.stderr.decode("utf-8", "replace"))
    if child.returncode != 0:
        raise InputError(f"{path}: cannot be decoded, its decoder crashed; the file is damaged")
    with reading(path), np.load(io.BytesIO(child.stdout)) as arrays:
        return dict(arrays)


def main(module: str, file: str) -> int:
    """Decode in this process; 2 with the message on stderr for bad input."""
    try:
        _bound_memory()
        path = Path(file)
        with reading(path):
            arrays = importlib.import_module(module).decode(path, path.read_bytes())
            content = io.BytesIO()
            np.savez(content, **{shortened(name, 60): values for name, values in arrays.items()})
        sys.stdout.buffer.write(content.getvalue())
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
