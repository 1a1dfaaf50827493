"""Where results are kept that cost time to find and can be found again."""

import os
import sys
from pathlib import Path


def cache_folder() -> Path:
    """The user's folder for foreride's cached results; need not exist yet.

    FORERIDE_CACHE names it; otherwise it is where the platform keeps such things.
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
