"""Draw of mutants by seed and the test files that judge each."""

import ast
import random
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from benchmarks.mutation.operators import mutations

LOOPS = ("tests/scenarios/simulation", "tests/closed_loop")
"""Folders of tests that drive."""


@dataclass(frozen=True)
class Mutant:
    """One mutation: the file that it changes, relative to the repository, and its number in that file."""

    file: str
    number: int


def drawn(root: Path, packages: Sequence[str], count: int, seed: int) -> list[Mutant]:
    """Distinct mutants drawn uniformly from all mutations of the packages' files."""
    every = [
        Mutant(str(path.relative_to(root)), number)
        for package in packages
        for path in sorted((root / package).rglob("*.py"))
        for number in range(len(list(mutations(ast.parse(path.read_text())))))
    ]
    return random.Random(seed).sample(every, min(count, len(every)))


def files_judging(root: Path, file: str) -> list[str]:
    """Test files of a module, the nearest first: its own, those that import it, those of its room."""
    module = Path(file).with_suffix("")
    name = _name(file)
    room = root / "tests" / module.parent
    own = [room / f"test_{module.name}.py"]
    package = sorted((root / "tests" / module.parts[0]).rglob("test_*.py"))
    importing = [path for path in package if re.search(rf"{re.escape(name)}\s", path.read_text())]
    nearest = dict.fromkeys([*own, *importing, *sorted(room.glob("test_*.py"))])
    return [str(path.relative_to(root)) for path in nearest if path.exists()]


def files_elsewhere(root: Path, file: str) -> list[str]:
    """Other test files of the suite that import a module or one that imports it, and the closed loops."""
    names = [_name(file)]
    for path in root.rglob("*.py"):
        if re.search(rf"{re.escape(names[0])}\s", path.read_text()):
            names.append(_name(str(path.relative_to(root))))
    pattern = re.compile(rf"({'|'.join(map(re.escape, names))})\s")
    loops = [path for room in LOOPS for path in sorted((root / room).glob("test_*.py"))]
    importing = [
        path for path in sorted((root / "tests").rglob("test_*.py")) if pattern.search(path.read_text())
    ]
    found = [str(path.relative_to(root)) for path in dict.fromkeys([*importing, *loops])]
    return [name for name in found if name not in files_judging(root, file)]


def _name(file: str) -> str:
    return "foreride." + ".".join(Path(file).with_suffix("").parts).removesuffix(".__init__")
