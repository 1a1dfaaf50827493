"""Location of the machine code that Numba compiles, and of Matplotlib's font list.

Numba keeps machine code beside the source and refuses to compile if no cache can be written. In that case
the code goes to foreride's cache folder; without any folder each process compiles for itself.
"""

import os
from pathlib import Path

from foreride.files.cache import cache_folder, temporary_folder, writable

PACKAGES = ("files", "road", "preview", "controller", "vehicle", "comfort", "scenarios")
"""Packages with compiled functions."""
SOURCE = Path(__file__).resolve().parents[1]
"""Folder of all packages."""


def _prepare() -> Path | None:
    """Cache folder of the machine code, set for Numba; None if nothing can be written."""
    folder = cache_folder()
    if folder is None or not writable(folder):
        folder = temporary_folder()
        if folder is not None:
            os.environ.setdefault("MPLCONFIGDIR", str(folder / "matplotlib"))
    cache_dir = os.environ.get("NUMBA_CACHE_DIR")
    if cache_dir and writable(Path(cache_dir)):
        return Path(cache_dir)
    if all(writable(part / "__pycache__") for part in {source.parent for source in _sources()}):
        return SOURCE
    if folder is None or not writable(compiled_folder := folder / "compiled"):
        return None
    os.environ["NUMBA_CACHE_DIR"] = str(compiled_folder)
    return compiled_folder


def _sources() -> list[Path]:
    return sorted(path for package in PACKAGES for path in (SOURCE / package).rglob("*.py"))


CACHE = _prepare()
"""Cache folder of the machine code: the root of the source for the default place, None for none."""
