"""User cache directory for results that are expensive to compute."""

import os
import sys
from pathlib import Path


def cache_folder() -> Path:
    """Return foreride's cache directory; it need not exist yet.

    FORERIDE_CACHE overrides the platform's default location.
    """
    if named := os.environ.get("FORERIDE_CACHE"):
        return Path(named)
    if sys.platform == "win32":
        base = Path(os.environ.get("LOCALAPPDATA") or Path.home() / "AppData" / "Local")
    elif sys.platform == "darwin":
        base = Path.home() / "Library" / "Caches"
    else:
        base = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    return base / "foreride"
