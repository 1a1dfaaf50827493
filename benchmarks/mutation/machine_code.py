"""Numba's machine code in the copy: of the unchanged functions, for all mutants but those that change them.

Numba checks the file of a compiled function, not those of the functions that it calls: a mutant of a called
function would be judged by the code of the unchanged one.
"""

import re
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

COMPILED = re.compile(r"^@njit", re.MULTILINE)
CODE = "__pycache__/*.nb[ic]"


def copy_code(root: Path, folder: Path) -> None:
    """Copy the machine code that a checkout has, for sources copied with their time stamps."""
    for path in root.glob(f"[!.b]*/**/{CODE}"):
        place = folder / path.relative_to(root)
        if place.parent.parent.is_dir():
            place.parent.mkdir(exist_ok=True)
            shutil.copy2(path, place)


def is_compiled(folder: Path, file: str) -> bool:
    """Whether a file has compiled functions."""
    return COMPILED.search((folder / file).read_text()) is not None


@contextmanager
def code_aside(folder: Path, file: str) -> Iterator[None]:
    """Without the machine code of a file and of those that import it; back as it was afterwards."""
    if not is_compiled(folder, file):
        yield
        return
    aside = folder.with_name("aside")
    moved = {code: aside / str(i) for i, code in enumerate(_code_of(folder, file))}
    aside.mkdir()
    for code, place in moved.items():
        code.rename(place)
    try:
        yield
    finally:
        for code in _code_of(folder, file):
            code.unlink()
        for code, place in moved.items():
            place.rename(code)
        aside.rmdir()


def _code_of(folder: Path, file: str) -> list[Path]:
    paths = [folder / name for name in sorted(importers(folder, file))]
    return [code for path in paths for code in path.parent.glob(f"__pycache__/{path.stem}.*.nb[ic]")]


def importers(folder: Path, file: str) -> set[str]:
    """Files with compiled functions that import a file, through others or directly, and the file itself."""
    sources = {
        str(path.relative_to(folder)): text
        for path in folder.rglob("*.py")
        if COMPILED.search(text := path.read_text()) or str(path.relative_to(folder)) == file
    }
    found, new = {file}, {file}
    while new:
        names = "|".join(re.escape("foreride." + one[:-3].replace("/", ".")) for one in new)
        new = {name for name, text in sources.items() if re.search(rf"({names})\s", text)} - found
        found |= new
    return found
