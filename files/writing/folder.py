"""Output folders: written atomically, and replaced only if foreride made them."""

import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import BinaryIO

from foreride.files.errors import InputError, printable, shown
from foreride.files.writing import marker
from foreride.files.writing.atomic import write_text, writing
from foreride.files.writing.exchange import swap_in
from foreride.files.writing.marker import Marker
from foreride.files.writing.scratch import (
    MARKER,
    is_scratch,
    lock_open_file,
    parent_lock,
    scratch_folder,
    sync,
)
from foreride.files.writing.targets import check_parent

DERIVED = ("report.html",)
"""Files derived from others in a folder, and removed with them."""


@dataclass(frozen=True)
class Draft:
    """Folder during writing. name: its final path. sha256: hashes of the files in it."""

    folder: Path
    name: Path
    sha256: dict[str, str] = field(default_factory=dict)

    def write(self, name: str, data: bytes | str) -> None:
        """Add a file; `name` is its path within the folder, with / as separator."""
        content = data.encode() if isinstance(data, str) else data
        with self.stream(name, len(content)) as stream:
            stream.write(content)

    @contextmanager
    def stream(self, name: str, size: int | None = None) -> Iterator[BinaryIO]:
        """Stream of a file to be added, closed at the end of the block.

        size: number of its bytes, if known, which an error tells.
        """
        path = self.folder / name
        with writing(self.name / name, size):
            path.parent.mkdir(parents=True, exist_ok=True)
            with path.open("wb") as file:
                yield file
                file.flush()
                os.fsync(file.fileno())
        self.sha256[name] = marker.digest_of_file(path)


@contextmanager
def atomic_folder(path: Path, kind: str) -> Iterator[Draft]:
    """Yield a draft that becomes the folder at `path` on success and is removed on failure.

    An existing folder of the same kind is replaced only once the new one is complete; files added to it by
    others are kept. Any other folder that is not empty raises InputError, before the block.
    """
    path = check_folder(path, kind)
    with scratch_folder(path) as scratch:
        draft = Draft(scratch, path)
        yield draft
        draft.write(MARKER, Marker(kind, dict(sorted(draft.sha256.items()))).to_json())
        for folder, _, _ in os.walk(scratch):
            sync(Path(folder))
        with parent_lock(path):
            check_folder(path, kind)
            _carry(path, scratch)
            swap_in(scratch, path)
            _carry(scratch, path)  # files added during the swap
        sync(path.parent)


def check_folder(path: Path, kind: str) -> Path:
    """Return the folder that `path` is or links to, if foreride may replace it, else raise InputError.

    It may if the folder is missing, empty, or made by foreride as of this kind, and is no process's working
    folder.
    """
    target = Path(os.path.realpath(path))
    if target in (working_folder := Path.cwd(), *working_folder.parents, Path.home()):
        raise InputError(f"{printable(path)}: must not be the working folder, one above it, or your home")
    _refuse_foreign(target, path, kind)
    check_parent(target)
    return target


def claim(path: Path, kind: str) -> Path:
    """Make `path` a folder to which foreride adds files; InputError unless it is empty or of this kind."""
    target = Path(os.path.realpath(path))
    if not (target.is_dir() and all(_is_ours(target / name) for name in _names(target))):
        _refuse_foreign(target, path, kind)
    check_parent(target / MARKER)
    if not (target / MARKER).exists():
        write_text(target / MARKER, Marker(kind, {}).to_json())
    return path


@contextmanager
def exclusive(folder: Path) -> Iterator[None]:
    """Lock a claimed folder for this process; InputError if another one holds it."""
    with open(folder / MARKER, "rb") as marked:
        try:
            lock_open_file(marked.fileno())
        except BlockingIOError:
            raise InputError(f"{printable(folder)}: another process is writing there") from None
        yield


def _refuse_foreign(target: Path, path: Path, kind: str) -> None:
    if not os.path.lexists(target):
        return
    if not target.is_dir():
        raise InputError(f"{printable(path)}: must be a folder, a file is there")
    present = marker.read(target)
    if present is None and _names(target):
        raise InputError(
            f"{printable(path)}: is not empty and has no {MARKER}, by which foreride knows its own folders: "
            f"nothing is written; choose a new one (a folder of an earlier version is taken with a file "
            f"{MARKER} in it that reads {Marker(kind, {}).to_json().strip()})"
        )
    if present is not None and present.kind != kind:
        raise InputError(
            f"{printable(path)}: must be new, empty or of kind {kind}, got kind {shown(present.kind)}"
        )


def _names(folder: Path) -> list[str]:
    return [name for name in os.listdir(folder) if not is_scratch(name)]


def _is_ours(folder: Path) -> bool:
    return folder.is_dir() and (folder / MARKER).is_file()


def _carry(source: Path, target: Path) -> None:
    """Copy files that others have put into the folder `source` to `target`."""
    if not source.is_dir():
        return
    present = marker.read(source)
    listed = {} if present is None else present.sha256
    for name in marker.files_in(source):
        if name in listed or name in DERIVED or os.path.lexists(target / name):
            continue
        (target / name).parent.mkdir(parents=True, exist_ok=True)
        try:
            os.link(source / name, target / name, follow_symlinks=False)
        except OSError:  # file systems without links
            shutil.copy2(source / name, target / name, follow_symlinks=False)
