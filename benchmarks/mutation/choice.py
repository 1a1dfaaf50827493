"""Draw of mutants by seed and the tests that judge each."""

import ast
import random
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from benchmarks.mutation.operators import mutations
from benchmarks.mutation.reach import TestReach


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


def function_at(text: str, line: int) -> str | None:
    """Function or `Class.method` around a line of a source, None for a line outside of all."""

    def within(node: ast.AST, names: tuple[str, ...]) -> str | None:
        for child in ast.iter_child_nodes(node):
            if isinstance(child, ast.FunctionDef | ast.ClassDef):
                first = child.body[0].lineno if isinstance(child, ast.FunctionDef) else child.lineno
                if first <= line <= (child.end_lineno or line):
                    path = (*names, child.name)
                    return ".".join(path) if isinstance(child, ast.FunctionDef) else within(child, path)
        return None

    return within(ast.parse(text), ())


def own_tests(root: Path, file: str) -> str | None:
    """Test file that mirrors a module, if there is one."""
    module = Path(file)
    own = f"tests/{module.parent}/test_{module.stem}.py"
    return own if (root / own).exists() else None


def test_files(root: Path, packages: Sequence[str]) -> list[str]:
    """All test files of packages."""
    paths = [path for package in packages for path in sorted((root / "tests" / package).rglob("test_*.py"))]
    return [str(path.relative_to(root)) for path in paths]


def importing(root: Path, file: str, files: Iterable[str]) -> set[str]:
    """Those of some files that import a module."""
    name = "foreride." + ".".join(Path(file).with_suffix("").parts).removesuffix(".__init__")
    pattern = re.compile(rf"{re.escape(name)}\s")
    return {other for other in files if pattern.search((root / other).read_text())}


def judging(root: Path, file: str, function: str | None, tests: Sequence[TestReach]) -> list[TestReach]:
    """Tests that judge a mutant, in their order.

    Those that execute its function, the module's own first and then the cheapest; for a mutant outside of all
    functions any of its file, and of files that import it. After them the others of their files, which may
    share a fixture with those, and of the files that import the module.
    """
    places = {f"{file}:{function}"} if function else _functions(root, file, tests)
    reaching = {test for test in tests if not test.functions.isdisjoint(places)}
    own = own_tests(root, file)
    files = {test.file for test in reaching} | {own}
    files |= importing(root, file, {test.file for test in tests})
    return sorted(
        (test for test in tests if test.file in files),
        key=lambda test: (test.file != own, test not in reaching, test.seconds),
    )


def _functions(root: Path, file: str, tests: Sequence[TestReach]) -> set[str]:
    """Functions that some tests execute of a file and of those that import it."""
    executed = {name for test in tests for name in test.functions}
    sources = {name.split(":")[0] for name in executed} - {test.file for test in tests}
    files = {file} | importing(root, file, filter(lambda name: (root / name).exists(), sources))
    return {name for name in executed if name.split(":")[0] in files}


def within_time(tests: Sequence[TestReach], seconds: float) -> list[TestReach]:
    """First tests of a sequence that take no longer than a time together, and at least one."""
    total = 0.0
    chosen: list[TestReach] = []
    for test in tests:
        total += test.seconds
        if chosen and total > seconds:
            break
        chosen.append(test)
    return chosen
