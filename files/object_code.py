"""Cache of object code: machine code that a compiler made, by the hash of all that it depends on."""

import hashlib
import os
from collections.abc import Callable, Iterable
from contextlib import suppress
from pathlib import Path

from foreride.files.cache import cached
from foreride.files.errors import InputError
from foreride.files.reading.regular_file import read_bytes
from foreride.files.writing.atomic import write_bytes

MAX_FILES = 200
"""Files kept; those unused for longest are deleted."""
_DIGEST_BYTES = hashlib.sha256().digest_size
_MAX_BYTES = 1 << 24


def object_code(source: Iterable[bytes], compiled: Callable[[], bytes]) -> bytes:
    """Object code from the cache, else what `compiled` returns, which is then kept.

    source: everything that determines the code. A file that is damaged or of another source is replaced.
    """
    key = hashlib.sha256(b"".join(hashlib.sha256(part).digest() for part in source)).digest()
    path = cached(f"kernels/{key.hex()}.o")
    code = _read(path, key)
    if code is None:
        code = compiled()
        with suppress(OSError):  # code that cannot be cached still serves this process
            write_bytes(path, _digest(key, code) + code)
            _delete_oldest(path.parent)
    return code


def _read(path: Path, key: bytes) -> bytes | None:
    """Code in a file; None if there is no sound one."""
    if not path.is_file():
        return None
    try:
        content = read_bytes(path, _MAX_BYTES)
    except InputError:
        return None
    digest, code = content[:_DIGEST_BYTES], content[_DIGEST_BYTES:]
    with suppress(OSError):
        os.utime(path)
    return code if digest == _digest(key, code) else None


def _digest(key: bytes, code: bytes) -> bytes:
    return hashlib.sha256(key + code).digest()


def _delete_oldest(folder: Path) -> None:
    """Delete the files last used, beyond the number kept."""
    used_ns = {path: path.stat().st_mtime_ns for path in folder.glob("*.o")}
    for path in sorted(used_ns, key=lambda path: used_ns[path])[:-MAX_FILES]:
        path.unlink(missing_ok=True)
