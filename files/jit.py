"""Numba compilation with a cache where one can be written."""

import os
from typing import Any

import numba

from foreride.files.compiled import CACHE

# The environment is read when Numba is imported, which another library may have done before.
numba.config.CACHE_DIR = os.environ.get("NUMBA_CACHE_DIR", "")  # type: ignore[attr-defined]


def njit(*arguments: Any, **options: Any) -> Any:
    """Wrapper of `numba.njit` with the cache, if there is one."""
    compiler: Any = numba.njit
    return compiler(*arguments, cache=CACHE is not None, **options)
