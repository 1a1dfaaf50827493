"""Heap of the C library: one for all threads, since each thread's own keeps what it has freed."""

import ctypes
import sys

_ARENA_MAX = -8  # M_ARENA_MAX of glibc's malloc.h


def share_heap() -> None:
    """Let threads to come share the heap of the main thread, where the C library is glibc.

    Images that one thread allocates and another one frees otherwise leave holes in several heaps.
    """
    if sys.platform == "linux":
        set_option = getattr(ctypes.CDLL(None), "mallopt", None)
        if set_option is not None:
            set_option(_ARENA_MAX, 1)
