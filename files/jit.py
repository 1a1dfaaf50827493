"""Numba compilation with a cache where one can be written, which notices changes in other modules.

For what is slow to compile, see the copies of arrays at the end.
"""

import gc
import os
from typing import Any, Self

import numba
from numba.core import event as events
from numba.core.caching import InTreeCacheLocator, UserProvidedCacheLocator

from foreride.files.compiled import CACHE
from foreride.files.stamp import stamp

_DEFAULT = (
    "UserProvidedCacheLocator,InTreeCacheLocator,UserWideCacheLocator,IPythonCacheLocator,ZipCacheLocator"
)


def njit(*arguments: Any, **options: Any) -> Any:
    """Wrapper of `numba.njit` with the cache, if there is one."""
    compiler: Any = numba.njit
    return compiler(*arguments, cache=CACHE is not None, no_cfunc_wrapper=True, **options)


class _WithoutSearches(events.Listener):  # type: ignore[misc]
    """Keeps the garbage collector off while a function compiles, which makes many objects that last."""

    def __init__(self) -> None:
        self._depth, self._enabled = 0, False

    def on_start(self, event: Any) -> None:
        if self._depth == 0:
            self._enabled = gc.isenabled()
            gc.disable()
        self._depth += 1

    def on_end(self, event: Any) -> None:
        self._depth -= 1
        if self._depth == 0 and self._enabled:
            gc.enable()


events.register("numba:compile", _WithoutSearches())


class _Stamped:
    """Location of the machine code of functions that the `njit` above compiles."""

    _names: dict[str, Any]

    @classmethod
    def from_function(cls, py_func: Any, py_file: str) -> Self | None:
        if py_func.__globals__.get("njit") is not njit:
            return None
        found: Any = super().from_function(py_func, py_file)  # type: ignore[misc]
        if found is not None:
            found._names = py_func.__globals__
        return found  # type: ignore[no-any-return]

    def get_source_stamp(self) -> Any:
        return super().get_source_stamp(), stamp(self._names)  # type: ignore[misc]


class StampedUserProvided(_Stamped, UserProvidedCacheLocator):  # type: ignore[misc]
    """In NUMBA_CACHE_DIR."""


class StampedInTree(_Stamped, InTreeCacheLocator):  # type: ignore[misc]
    """Beside the source."""


# The environment is read when Numba is imported, which another library may have done before.
_config: Any = numba.config
_config.CACHE_DIR = os.environ.get("NUMBA_CACHE_DIR", "")
_config.CACHE_LOCATOR_CLASSES = ",".join(
    [f"{__name__}.{one.__name__}" for one in (StampedUserProvided, StampedInTree)]
    + [getattr(_config, "CACHE_LOCATOR_CLASSES", "") or _DEFAULT]
)


# An assignment of an array to a slice, `target[:] = source`, makes Numba compile the text of the error for
# other shapes, too: 2 500 lines of LLVM for each function with one, against 150 for these loops.
@njit
def copy_vector(source: Any, target: Any) -> None:
    """Copy the entries (n,) of one array into another."""
    for i in range(len(target)):
        target[i] = source[i]


@njit
def copy_matrix(source: Any, target: Any) -> None:
    """Copy the entries (m, n) of one array into another."""
    for i in range(target.shape[0]):
        for j in range(target.shape[1]):
            target[i, j] = source[i, j]
