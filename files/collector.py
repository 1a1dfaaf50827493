"""Cyclic garbage collector: imported modules are kept out of its searches, as they are never garbage."""

import gc
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module


@contextmanager
def unsearched() -> Iterator[None]:
    """Make no search for garbage within the block, and never search what is there at its end.

    The libraries of a simulation make two hundred thousand objects, which would be searched several times
    while they are imported. Once in a process, so that repeated use keeps no garbage; nothing is done where
    the collector is off.
    """
    if gc.get_freeze_count() or not gc.isenabled():
        yield
        return
    gc.disable()
    try:
        yield
    finally:
        gc.freeze()
        gc.enable()


def import_unsearched(module: str) -> None:
    """Import a module for the life of the process, as the initializer of a worker."""
    with unsearched():
        import_module(module)
