"""Atomic writing of files, through links, to devices and pipes, and with the umask's permissions."""

import os
import shutil
import stat
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import BinaryIO

from foreride.files.errors import InputError, printable
from foreride.files.writing.scratch import lock_open_file, parent_lock, scratch_folder, scratch_name, sync


def write_bytes(path: Path, data: bytes) -> None:
    """Replace the file at `path` by `data` atomically; a reader sees the old file or the new one.

    Links are followed. Devices, pipes and this program's own output streams are written to, not replaced.
    An OSError names `path` and the bytes needed.
    """
    with writing(path, len(data)):
        if (stream := _stream(path)) is not None:
            with stream:
                stream.write(data)
            return
        with _replacing(Path(os.path.realpath(path))) as scratch:
            scratch.write(data)


def write_text(path: Path, text: str) -> None:
    """Replace `path` by `text` (UTF-8) atomically."""
    write_bytes(path, text.encode())


@contextmanager
def writing(path: Path, size: int | None) -> Iterator[None]:
    """Convert an OSError of the block to one that names the file and the size to be written, if known."""
    try:
        yield
    except OSError as error:
        needed = "" if size is None else f"; {size:,} bytes to write".replace(",", " ")
        reason = f"{error.strerror or error}{needed}"
        raise OSError(error.errno, reason, str(path)) from None


@contextmanager
def _replacing(path: Path) -> Iterator[BinaryIO]:
    """Stream whose content replaces `path` if the block ends without error."""
    permissions = _mode(path)
    with parent_lock(path):
        name = scratch_name(path)
        handle = os.open(name, os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0), 0o666)
        lock_open_file(handle)
    try:
        with os.fdopen(handle, "wb") as stream:
            yield stream
            stream.flush()
            os.fsync(handle)
            if permissions is not None:
                os.chmod(name, permissions)
            if os.name != "nt":  # still locked: must not look like that of a dead process
                os.replace(name, path)
        if os.name == "nt":
            os.replace(name, path)
    except BaseException:
        name.unlink(missing_ok=True)
        raise
    sync(path.parent)


def _mode(path: Path) -> int | None:
    """Permissions of the file to be replaced; PermissionError if it must not be written."""
    if not path.exists():
        return None
    if not os.access(path, os.W_OK):
        raise PermissionError(13, "Permission denied", str(path))
    return stat.S_IMODE(path.stat().st_mode)


def _stream(path: Path) -> BinaryIO | None:
    """Stream for a target that is not replaced: a device, a pipe, our own output; None for a plain file."""
    try:
        status = os.stat(path)
    except FileNotFoundError:
        return None
    for stream in filter(None, (sys.stdout, sys.stderr, sys.__stdout__)):
        with suppress(OSError, ValueError, AttributeError):
            if os.path.samestat(status, os.fstat(stream.fileno())):
                stream.flush()
                return os.fdopen(os.dup(stream.fileno()), "wb")
    if stat.S_ISBLK(status.st_mode) or stat.S_ISSOCK(status.st_mode):
        raise InputError(f"{printable(path)}: must be a file, not a block device or a socket")
    special = stat.S_ISCHR(status.st_mode) or stat.S_ISFIFO(status.st_mode)
    folder = os.path.realpath(path.parent)
    if special or folder == "/dev" or folder.startswith("/proc/"):  # open files of a process, by number
        return path.open("ab" if stat.S_ISREG(status.st_mode) else "wb")
    return None


@contextmanager
def replaced(path: Path) -> Iterator[Path]:
    """Yield a path of the same suffix for libraries that write by name; on success it replaces `path`."""
    target = Path(os.path.realpath(path))
    with scratch_folder(target) as folder:
        complete = folder / f"whole{path.suffix}"
        yield complete
        size = complete.stat().st_size
        with complete.open("rb") as source, writing(path, size), _replacing(target) as stream:
            shutil.copyfileobj(source, stream)
