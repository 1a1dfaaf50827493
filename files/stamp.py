"""Stamps of compiled functions: hashes of what they take from other modules.

Numba's cache holds machine code for current as long as the file of its function is unchanged. Functions and
constants of other modules are compiled into it, too.
"""

import hashlib
import sys
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

_SCALARS = (bool, int, float, complex, str, bytes, np.generic)


def stamp(names: Mapping[str, Any]) -> bytes:
    """Hash of the functions and constants among the global names of a module."""
    hasher = hashlib.sha256()
    for name in sorted(names):
        if not name.startswith("__"):
            for part in _parts(names[name], names["__name__"]):
                hasher.update(name.encode() + b"=" + part + b"\n")
    return hasher.digest()


def _parts(value: Any, importer: str) -> Iterator[bytes]:
    """What machine code may contain of a value; nothing for what cannot be compiled."""
    if isinstance(value, _SCALARS):
        yield repr(value).encode()
    elif isinstance(value, np.ndarray) and not value.dtype.hasobject:
        yield f"{value.dtype.str} {value.shape}".encode() + value.tobytes()
    elif isinstance(value, tuple):
        for item in value:
            yield from _parts(item, importer)
    elif isinstance(value, type) and issubclass(value, tuple) and hasattr(value, "_fields"):
        yield repr(value._fields).encode()
    elif isinstance(value, ModuleType) and value.__name__.startswith("foreride."):
        yield module_stamp(value.__name__)
    elif (function := getattr(value, "py_func", None)) and function.__module__ != importer:
        yield module_stamp(function.__module__)


@cache
def module_stamp(name: str) -> bytes:
    """Hash of an imported module: its file, and what its compiled functions take from others."""
    module = sys.modules[name]
    source = Path(module.__file__ or "")
    return hashlib.sha256((source.read_bytes() if source.is_file() else b"") + stamp(vars(module))).digest()
