"""A guard for processes that try damaged input: they write and remove nothing outside scratch folders."""

import os
import sys
import tempfile
from typing import Any

SCRATCH = "foreride-fuzz-"
_CHANGES = {
    "os.rename": 2, "os.remove": 1, "os.rmdir": 1, "os.mkdir": 1, "os.link": 2, "os.symlink": 2,
    "os.truncate": 1, "os.chmod": 1, "os.chown": 1, "shutil.rmtree": 1, "os.utime": 1,
}  # fmt: skip
_WRITES = os.O_WRONLY | os.O_RDWR | os.O_CREAT | os.O_TRUNC | os.O_APPEND


def confine() -> None:
    """Refuse from now on, as the system would, whatever this process does to files of others."""
    scratch = os.path.join(os.path.realpath(tempfile.gettempdir()), SCRATCH)

    def allowed(path: Any) -> bool:
        if isinstance(path, int):
            return True
        place = os.path.realpath(os.fsdecode(path))
        return place.startswith(scratch) or place == os.devnull or "__pycache__" in place

    def judge(event: str, given: tuple[Any, ...]) -> None:
        if event == "open":
            path, _, flags = given
            if flags & _WRITES and not allowed(path):
                raise PermissionError(13, "Permission denied", path)
        elif event in _CHANGES:
            for path in given[: _CHANGES[event]]:
                if not allowed(path):
                    raise PermissionError(13, "Permission denied", path)

    sys.addaudithook(judge)
