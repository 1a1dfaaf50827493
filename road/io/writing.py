"""Writing of roads as CSV profiles and ASAM OpenCRG, so that other tools can drive over them."""

import tempfile
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from foreride.files.errors import InputError
from foreride.files.writing.atomic import write_bytes, write_text

Array = NDArray[np.float64]
WRITABLE = (".csv", ".crg")


def write_surface(path: Path, x_m: Array, y_m: Array, heights: Array) -> None:
    """Write heights (m, n) on lines y_m (m,) at stations x_m (n,), to a micrometre; OpenCRG needs even ones.

    A single line is the whole width. Raises InputError for a path of another ending.
    """
    if path.suffix.lower() == ".csv":
        write_text(path, _csv(x_m, y_m, heights))
    elif path.suffix.lower() == ".crg":
        write_bytes(path, _crg(x_m, y_m, heights))
    else:
        raise InputError(f"{path}: a road is written as {' or '.join(WRITABLE)}")


def _csv(x_m: Array, y_m: Array, heights: Array) -> str:
    names = ["z_m"] if len(y_m) == 1 else [f"y={y:.10g}" for y in y_m]
    rows = (
        ",".join([f"{x:.10g}", *(f"{z:.6f}" for z in column)])
        for x, column in zip(x_m, heights.T, strict=True)
    )
    return "\n".join([",".join(["x_m", *names]), *rows]) + "\n"


def _crg(x_m: Array, y_m: Array, heights: Array) -> bytes:
    import pyopencrg

    if len(y_m) == 1:
        y_m, heights = np.array([-2.0, 2.0]), np.repeat(heights, 2, axis=0)
    step_m = float(x_m[-1] - x_m[0]) / (len(x_m) - 1)
    even = x_m[0] + step_m * np.arange(len(x_m))
    if np.abs(even - x_m).max() > 1e-6:
        raise InputError("OpenCRG needs even stations; give a step")
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "road.crg"
        pyopencrg.CrgRoad(heights.T.copy(), step_m, y_m).save(file, fmt="KDBI")
        return file.read_bytes()
