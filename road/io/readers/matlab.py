"""Road profiles in MATLAB files, with one variable per column: version 5 by SciPy, 7.3 (HDF5) by h5py."""

import io
from pathlib import Path
from typing import Any

import numpy as np

from foreride.files.errors import InputError
from foreride.road.io.raw_profile import RawProfile
from foreride.road.io.readers.columns import profile_of_columns
from foreride.road.io.readers.isolated import decoded
from foreride.road.io.reading_options import ReadingOptions

LIMIT = 256 << 20
_HDF5 = b"\x89HDF\r\n\x1a\n"


def read(path: Path, options: ReadingOptions) -> RawProfile:
    """Profile of the variables that `road.io.readers.columns` chooses."""
    variables = decoded("matlab", path, LIMIT)
    return profile_of_columns(path, list(variables), variables.__getitem__, options)


def decode(path: Path, data: bytes) -> dict[str, Any]:
    """Numeric variables of a file."""
    variables = _hdf5(path, data) if _HDF5 in data[:1024] else _version_5(data)
    arrays = {name: np.asarray(values) for name, values in variables.items()}
    return {name: values for name, values in arrays.items() if values.dtype.kind in "fiu"}


def _version_5(data: bytes) -> dict[str, Any]:
    from scipy.io import loadmat

    found = loadmat(io.BytesIO(data), squeeze_me=True)
    return {name: values for name, values in found.items() if not name.startswith("__")}


def _hdf5(path: Path, data: bytes) -> dict[str, Any]:
    try:
        import h5py
    except ImportError:
        raise InputError(f"{path}: MATLAB 7.3 needs h5py: pip install 'foreride[roads]'") from None
    with h5py.File(io.BytesIO(data), "r") as file:
        columns = {name: item for name, item in file.items() if isinstance(item, h5py.Dataset)}
        if sum(item.size for item in columns.values()) > LIMIT // 8:
            raise InputError(f"{path}: may hold at most {LIMIT // 8} numbers")
        return {name: item[()] for name, item in columns.items()}
