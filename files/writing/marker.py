"""Marker file of folders made by foreride: their kind and the checksums of their files."""

import hashlib
import json
import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from foreride.files.errors import InputError, printable, shown
from foreride.files.reading.regular_file import read_bytes, read_text
from foreride.files.writing.scratch import MARKER, is_scratch

VERSION = 1


@dataclass(frozen=True)
class Marker:
    """Marker of a folder. kind: its kind. sha256: hash of each file by its path, empty if files are added."""

    kind: str
    sha256: dict[str, str]

    def to_json(self) -> str:
        """Text of the marker file."""
        document = {"kind": self.kind, "version": VERSION}
        if self.sha256:
            return json.dumps(document | {"sha256": self.sha256}, indent=2, sort_keys=True) + "\n"
        return json.dumps(document) + "\n"


def read(folder: Path) -> Marker | None:
    """Read the folder's marker; None if there is none. InputError for a damaged or unknown one."""
    path = folder / MARKER
    if not path.exists():
        return None
    try:
        document = json.loads(read_text(path))
        version, kind, sums = document["version"], document["kind"], document.get("sha256", {})
        valid = (
            isinstance(kind, str)
            and all(map(_is_inside, sums))
            and all(isinstance(sha256, str) for sha256 in sums.values())
        )
    except (ValueError, TypeError, KeyError, AttributeError, RecursionError):
        valid = False
    if not valid:
        raise InputError(f"{printable(path)}: is damaged")
    if version != VERSION:
        raise InputError(f"{printable(path)}: version must be {VERSION}, got {shown(version)}")
    return Marker(kind, sums)


def seal(folder: Path, kind: str) -> None:
    """Write the marker of a folder in its present state, with the checksums of all files in it."""
    sums = {name: digest_of_file(folder / name) for name in sorted(files_in(folder))}
    (folder / MARKER).write_text(Marker(kind, sums).to_json())


def verified(folder: Path, kind: str) -> dict[str, bytes]:
    """Return the content of all files that the marker lists, after checking their hashes.

    Raises InputError for a folder of another kind or without a marker, and for a damaged or missing file.
    """
    if is_scratch(folder.name):
        raise InputError(f"{printable(folder)}: half-finished, its process was killed")
    while True:
        present = read(folder)
        if present is None or present.kind != kind:
            raise InputError(_unmarked(folder, kind, present))
        try:
            return {name: _checked(folder / name, sha256) for name, sha256 in present.sha256.items()}
        except InputError:
            if read(folder) == present:  # else it has been replaced by a new one meanwhile
                raise


def digest(data: bytes) -> str:
    """SHA-256 in hexadecimal digits."""
    return hashlib.sha256(data).hexdigest()


def digest_of_file(path: Path) -> str:
    """SHA-256 of a file's content, of any size."""
    with path.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def files_in(folder: Path) -> Iterator[str]:
    """Paths within the folder of all files except the marker, with / as separator."""
    for place, folders, files in os.walk(folder):
        links = [name for name in folders if os.path.islink(os.path.join(place, name))]
        for name in files + links:
            relative = Path(place, name).relative_to(folder).as_posix()
            if relative != MARKER:
                yield relative


def _is_inside(name: str) -> bool:
    path = PurePosixPath(name)
    return not path.is_absolute() and ".." not in path.parts and path.name not in ("", MARKER)


def _checked(path: Path, sha256: str) -> bytes:
    if not path.exists():
        raise InputError(f"{printable(path.parent)}: half-finished or damaged, {path.name} is missing")
    data = read_bytes(path)
    if digest(data) != sha256:
        raise InputError(f"{printable(path)}: is damaged (its SHA-256 is not that in {MARKER})")
    return data


def _unmarked(folder: Path, kind: str, present: Marker | None) -> str:
    if present is not None:
        return f"{printable(folder)}: must be of kind {kind}, got {shown(present.kind)} ({MARKER})"
    if not folder.is_dir():
        return f"{printable(folder)}: {'must be a folder' if folder.exists() else 'no such folder'} ({kind})"
    reason = f"{MARKER} with the checksums is missing"
    return (
        f"{printable(folder)}: half-finished, or of a version without checksums ({reason}); create it again"
    )
