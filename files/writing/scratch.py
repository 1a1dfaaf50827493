"""Scratch files and folders beside the target of a write, locked while their process lives."""

import errno
import os
import re
import secrets
import shutil
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from foreride.files.command_line import notify

try:
    import fcntl
except ImportError:  # Windows has no such locks: scratch files of killed processes remain
    fcntl = None  # type: ignore[assignment]

MARKER = "foreride.json"
"""Marker file of a folder made by foreride; its lock in a scratch folder shows that the process lives."""
_KEPT = 40  # characters of the target's name, so that no name gets too long
_SCRATCH = re.compile(r"\..*\.[0-9a-f]{8}\.foreride-part", re.DOTALL)
_OLD = re.compile(r"\.(.*)\.[0-9a-f]{8}\.foreride-old", re.DOTALL)
_CLEANED: set[str] = set()


def is_scratch(name: str) -> bool:
    """Whether a file or folder of this name is scratch of a write, which must not be read."""
    return bool(_SCRATCH.fullmatch(name) or _OLD.fullmatch(name))


def scratch_name(target: Path) -> Path:
    """New name beside `target` for its replacement."""
    return target.with_name(f".{target.name[:_KEPT]}.{secrets.token_hex(4)}.foreride-part")


def old_name(target: Path) -> Path:
    """New name beside `target` for the present file or folder while it is moved aside."""
    return target.with_name(f".{target.name}.{secrets.token_hex(4)}.foreride-old")


@contextmanager
def parent_lock(target: Path) -> Iterator[None]:
    """Lock the folder that contains `target`, created if missing; scratch remains in it are removed.

    The kernel releases such a lock when its process ends in any way, so locks are never stale.
    """
    parent, handle = target.parent, None
    parent.mkdir(parents=True, exist_ok=True)
    with suppress(PermissionError):  # a folder may be writable but not readable
        handle = _lock(parent)
    try:
        if handle is not None and str(parent) not in _CLEANED:
            _CLEANED.add(str(parent))
            _clean(parent)
        yield
    finally:
        if handle is not None:
            os.close(handle)


@contextmanager
def scratch_folder(target: Path) -> Iterator[Path]:
    """Yield a new folder beside `target`; anything left at its name afterwards is removed."""
    try:
        with parent_lock(target):
            folder = scratch_name(target)
            os.mkdir(folder)
            handle = os.open(folder / MARKER, os.O_RDWR | os.O_CREAT | os.O_EXCL, 0o666)
            lock_open_file(handle)
    except OSError as error:
        raise OSError(error.errno, error.strerror, str(target)) from None
    try:
        yield folder
    finally:
        os.close(handle)
        shutil.rmtree(folder, ignore_errors=True)


def lock_open_file(handle: int) -> None:
    """Lock an open file for as long as it is open, if the file system supports it."""
    if fcntl is not None:
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            if error.errno in (errno.EWOULDBLOCK, errno.EACCES):
                raise


def sync(folder: Path) -> None:
    """Flush the names in a folder to disk, if the system supports it."""
    if os.name == "nt":
        return
    try:
        handle = os.open(folder, os.O_RDONLY)
    except PermissionError:  # a folder may be writable but not readable
        return
    try:
        os.fsync(handle)
    except OSError as error:
        if error.errno not in (errno.EINVAL, errno.ENOTSUP):
            raise
    finally:
        os.close(handle)


def _lock(path: Path, wait: bool = True) -> int | None:
    """Open and lock; None if the file system has no locks. Raises BlockingIOError if not to wait."""
    if fcntl is None:
        return None
    handle = os.open(path, os.O_RDONLY)
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB))
    except OSError as error:
        os.close(handle)
        if not wait and error.errno in (errno.EWOULDBLOCK, errno.EACCES):
            raise BlockingIOError(error.errno, error.strerror) from None
        return None
    return handle


def _clean(folder: Path) -> None:
    """Remove the scratch of dead processes; restore originals that such a process had moved aside."""
    for name in os.listdir(folder):
        aside, path = _OLD.fullmatch(name), folder / name
        if aside and not os.path.lexists(folder / aside[1]):
            os.rename(path, folder / aside[1])
            notify(f"put back {folder / aside[1]}, which a killed process had moved aside")
        elif is_scratch(name) and _is_dead(path):
            shutil.rmtree(path, ignore_errors=True) if path.is_dir() else path.unlink(missing_ok=True)
            notify(f"removed {path}, left by a killed process")


def _is_dead(scratch: Path) -> bool:
    locked_file = scratch / MARKER if scratch.is_dir() else scratch
    try:
        handle = _lock(locked_file, wait=False)
    except BlockingIOError:
        return False
    except FileNotFoundError:  # folders get their marker while the parent's lock is held
        return True
    except OSError:
        return False
    if handle is not None:
        os.close(handle)
    return handle is not None
