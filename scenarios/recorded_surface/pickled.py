"""Pickle files of plain values and NumPy arrays, read without executing what else a pickle can call."""

import io
import pickle
from pathlib import Path
from typing import Any

import numpy as np

from foreride.files.errors import InputError, shown
from foreride.files.reading.regular_file import read_bytes, reading

LIMIT = 16 << 20
_NUMPY = {"_reconstruct", "scalar", "_frombuffer"}
_MODULES = {
    "numpy.core.multiarray", "numpy._core.multiarray", "numpy.core.numeric", "numpy._core.numeric",
}  # fmt: skip
_CLASSES = {("numpy", "ndarray"): np.ndarray, ("numpy", "dtype"): np.dtype}


class _PlainUnpickler(pickle.Unpickler):
    """Unpickler that knows NumPy's arrays and no other class."""

    def find_class(self, module: str, name: str) -> Any:
        if (module, name) in _CLASSES:
            return _CLASSES[module, name]
        if (module in _MODULES and name in _NUMPY) or (module, name) == ("_codecs", "encode"):
            return super().find_class(module.replace("numpy.core", "numpy._core"), name)
        raise InputError(f"must hold plain values and arrays only, not {shown(f'{module}.{name}')}")


def read_pickle(path: Path) -> Any:
    """Content of a pickle file. Raises InputError for a damaged file and for one with other objects."""
    with reading(path):
        try:
            return _PlainUnpickler(io.BytesIO(read_bytes(path, LIMIT))).load()
        except InputError as error:
            raise InputError(f"{path}: {str(error).removeprefix(f'{path}: ')}") from None
