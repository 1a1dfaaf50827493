"""Atomic exchange of a folder with its replacement, where the system supports it."""

import ctypes
import errno
import os
from pathlib import Path

from foreride.files.writing.scratch import old_name

_RENAME_EXCHANGE = 2
_AT_FDCWD = -100
_LACKING = (errno.ENOSYS, errno.EINVAL, errno.ENOTSUP)
_TRIES = 100


def swap_in(scratch: Path, target: Path) -> None:
    """Move the folder `scratch` to `target`; a previous folder there is then at `scratch`."""
    for _ in range(_TRIES):  # without locks, other processes may write here as well
        try:
            if not os.path.lexists(target):
                os.rename(scratch, target)
            elif not exchange(scratch, target):
                step_aside(scratch, target)
            return
        except OSError as error:
            if error.errno not in (errno.ENOENT, errno.EEXIST, errno.ENOTEMPTY):
                raise
            last_error = error
    raise last_error


def exchange(first: Path, second: Path) -> bool:
    """Swap two names atomically; False if the system or its file system cannot."""
    try:
        rename = ctypes.CDLL(None, use_errno=True).renameat2
    except (AttributeError, OSError, TypeError):  # not Linux, or an old C library
        return False
    names = os.fsencode(first), os.fsencode(second)
    if rename(_AT_FDCWD, names[0], _AT_FDCWD, names[1], _RENAME_EXCHANGE) == 0:
        return True
    code = ctypes.get_errno()
    if code in _LACKING:
        return False
    raise OSError(code, os.strerror(code), str(second))


def step_aside(scratch: Path, target: Path) -> None:
    """Swap in three steps; `files.writing.scratch` restores the old folder if a kill leaves none."""
    aside = old_name(target)
    os.rename(target, aside)
    try:
        os.rename(scratch, target)
    except BaseException:
        os.rename(aside, target)
        raise
    os.rename(aside, scratch)
