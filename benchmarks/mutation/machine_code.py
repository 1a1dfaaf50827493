"""Numba's machine code of the unchanged copy and of mutants.

Numba checks the file of a compiled function, not those of the functions that it calls: a mutant of a called
function would be judged by the code of the unchanged one. Each such mutant has a cache of its own, without
the code of the modules that import it.
"""

import re
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

COMPILED = re.compile(r"^@njit", re.MULTILINE)


@contextmanager
def cache_of(folder: Path, cache: Path, file: str) -> Iterator[Path]:
    """Cache for the tests of a mutant of this file, relative to the copy `folder`; `cache` is the common one.

    A mutant without compiled functions uses the common one, and fills it.
    """
    if not COMPILED.search((folder / file).read_text()):
        yield cache
        return
    own = cache.with_name("of_mutant")
    shutil.copytree(cache, own)
    try:
        for name in importers(folder, file):
            for code in own.rglob(f"{Path(name).stem}.*"):
                code.unlink()
        yield own
    finally:
        shutil.rmtree(own)


def importers(folder: Path, file: str) -> set[str]:
    """Files with compiled functions that import a file, through others or directly, and the file itself."""
    sources = {
        str(path.relative_to(folder)): text
        for path in sorted(folder.rglob("*.py"))
        if COMPILED.search(text := path.read_text()) or str(path.relative_to(folder)) == file
    }
    found, new = {file}, {file}
    while new:
        names = "|".join(re.escape("foreride." + one[:-3].replace("/", ".")) for one in new)
        new = {name for name, text in sources.items() if re.search(rf"({names})\s", text)} - found
        found |= new
    return found
