"""Tests that modules, public classes and public functions have docstrings that begin with a name."""

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PACKAGES = (
    "comfort", "controller", "detector", "files", "foreride", "preview", "road", "scenarios", "vehicle",
)  # fmt: skip
QUESTIONS = {"what", "where", "who", "whose", "whether", "how", "which", "why", "when"}
INHERITED = {"forward"}
"""Methods documented by their base class in PyTorch."""
FILES = [path for package in PACKAGES for path in sorted((ROOT / package).rglob("*.py"))]

Named = ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef


def named(node: ast.AST, place: str, public: bool = True) -> Iterator[tuple[str, bool, Named]]:
    """Classes and functions below a node, without those inside functions; with whether they are public."""
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef):
            here = public and not child.name.startswith("_")
            yield f"{place} {child.name}", here, child
            if isinstance(child, ast.ClassDef):
                yield from named(child, f"{place} {child.name}.", here)


def needs_docstring(node: Named) -> bool:
    if not isinstance(node, ast.FunctionDef):
        return True
    decorators = {ast.unparse(decorator).rpartition(".")[2] for decorator in node.decorator_list}
    return node.name not in INHERITED and not decorators & {"overload", "setter"}


def first_word(node: Named) -> str:
    return (ast.get_docstring(node) or "-").split()[0].strip(",:;").lower()


def doors(path: Path) -> Iterator[tuple[str, bool, Named]]:
    tree = ast.parse(path.read_text())
    place = str(path.relative_to(ROOT))
    yield place, True, tree
    yield from named(tree, place)


@pytest.mark.parametrize("package", PACKAGES)
def test_whatever_is_public_has_a_docstring(package: str) -> None:
    found = [door for path in FILES if path.relative_to(ROOT).parts[0] == package for door in doors(path)]
    assert found
    assert [
        place
        for place, public, node in found
        if public and needs_docstring(node) and not ast.get_docstring(node)
    ] == []


def test_modules_and_classes_are_introduced_by_a_name() -> None:
    others = [
        path
        for folder in ("benchmarks", "docs", "examples", "tests")
        for path in (ROOT / folder).rglob("*.py")
    ]
    asking = [
        place
        for path in [*FILES, *others]
        for place, _, node in doors(path)
        if isinstance(node, ast.Module | ast.ClassDef) and first_word(node) in QUESTIONS
    ]
    assert asking == []
