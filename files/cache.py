"""Locations of cached results: the user's cache folder, or a private temporary one."""

import os
import stat
import sys
import tempfile
from functools import lru_cache
from pathlib import Path

from foreride.files.command_line import notify


def cache_folder() -> Path | None:
    """Return the user's folder for foreride's cached results, which may not exist yet; None without a home.

    FORERIDE_CACHE overrides the platform's default location.
    """
    if override := os.environ.get("FORERIDE_CACHE"):
        return Path(override)
    try:
        if sys.platform == "win32":
            base = Path(os.environ.get("LOCALAPPDATA") or Path.home() / "AppData" / "Local")
        elif sys.platform == "darwin":
            base = Path.home() / "Library" / "Caches"
        else:
            base = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    except RuntimeError:  # neither HOME nor an entry in the list of users
        return None
    return base / "foreride"


def cached(name: str) -> Path:
    """Path of one cached result: its present location, else a writable one."""
    folder = cache_folder()
    if folder is not None and ((folder / name).is_file() or writable(folder)):
        return folder / name
    return (temporary_folder() or folder or Path(tempfile.gettempdir())) / name


def writable(folder: Path) -> bool:
    """Whether a file can be created in the folder, which is created if missing."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        tempfile.TemporaryFile(dir=folder).close()
    except OSError:
        return False
    return True


@lru_cache(maxsize=1)
def temporary_folder() -> Path | None:
    """Return the user's own cache folder for temporary files, with one notice on stderr; None if impossible.

    Folders writable by others are not used, as cached machine code is executed.
    """
    user = os.getuid() if hasattr(os, "getuid") else "user"
    try:
        folder = Path(tempfile.gettempdir()) / f"foreride-{user}"
        folder.mkdir(mode=0o700, exist_ok=True)
        if not _private(folder) or not writable(folder):
            folder = Path(tempfile.mkdtemp(prefix="foreride-"))
    except OSError:
        return None
    unwritable = cache_folder() or "a home folder"
    notice = f"{unwritable} cannot be written, so caches are in {folder}; FORERIDE_CACHE names another folder"
    notify(notice)
    return folder


def _private(folder: Path) -> bool:
    """Whether the folder is not a link, and is owned by and open to this user alone."""
    status = folder.lstat()
    owned = not hasattr(os, "getuid") or (status.st_uid == os.getuid() and not status.st_mode & 0o077)
    return stat.S_ISDIR(status.st_mode) and owned
