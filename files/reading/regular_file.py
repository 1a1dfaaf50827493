"""Reading of data files: regular files of bounded size, every failure as a one-line InputError."""

import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from foreride.files.errors import InputError, printable, shortened

TEXT_LIMIT = 4 << 20
"""Maximum size of a hand-written text file, such as a scenario: 4 MiB."""
DATA_LIMIT = 1 << 30
"""Maximum size of a file of measured or recorded data: 1 GiB."""
_MESSAGE_LENGTH = 300


@contextmanager
def reading(source: Path | str) -> Iterator[None]:
    """Convert any exception of the block into an InputError that names `source`; InputErrors pass unchanged.

    For blocks that only parse untrusted data: a programming error inside would look like invalid input.
    """
    try:
        yield
    except InputError:
        raise
    except MemoryError:
        raise InputError(f"{printable(source)}: needs more memory than there is") from None
    except RecursionError:
        raise InputError(f"{printable(source)}: is nested too deeply") from None
    except OSError as error:
        raise InputError(
            f"{printable(source)}: cannot be read ({printable(error.strerror or error)})"
        ) from None
    except UnicodeError as error:
        raise InputError(f"{printable(source)}: is not UTF-8 text ({_one_line(error)})") from None
    except Exception as error:
        raise InputError(f"{printable(source)}: is invalid ({_one_line(error)})") from None


def read_bytes(path: Path | str, limit: int = DATA_LIMIT) -> bytes:
    """Read the regular file at `path`, of at most `limit` bytes.

    Raises InputError for anything else (directory, pipe, device), for a larger file, and for an unreadable
    one.
    """
    with reading(path):
        # Opened without blocking, so as not to wait for the other end of a pipe, and checked before reading.
        handle = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0))
        try:
            mode = os.fstat(handle).st_mode
            if not stat.S_ISREG(mode):
                raise InputError(f"{printable(path)}: must be a regular file, not {_kind(mode)}")
        except BaseException:
            os.close(handle)
            raise
        with os.fdopen(handle, "rb") as stream:
            data = stream.read(limit + 1)
    if len(data) > limit:
        raise InputError(f"{printable(path)}: must be at most {_size(limit)} large")
    return data


def read_text(path: Path | str, limit: int = TEXT_LIMIT, encoding: str = "utf-8") -> str:
    """Text of the regular file at `path`, at most `limit` bytes, line ends as `\\n`; raises InputError."""
    data = read_bytes(path, limit)
    with reading(path):
        text = data.decode(encoding).replace("\r\n", "\n").replace("\r", "\n")
    if "\0" in text:
        raise InputError(f"{printable(path)}: is not text, it holds NUL characters")
    return text


def _kind(mode: int) -> str:
    kinds = {stat.S_IFDIR: "a folder", stat.S_IFIFO: "a pipe", stat.S_IFSOCK: "a socket"}
    return kinds.get(stat.S_IFMT(mode), "a device")


def _size(limit: int) -> str:
    return (
        f"{limit >> 30} GiB"
        if limit >= 1 << 30
        else f"{limit >> 20} MiB"
        if limit >= 1 << 20
        else f"{limit} bytes"
    )


def _one_line(error: Exception) -> str:
    return shortened(printable(f"{type(error).__name__}: {error}"), _MESSAGE_LENGTH)
