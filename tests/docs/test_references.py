"""Tests that files and modules named in documentation and docstrings exist."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import foreride
from foreride.scenarios.definition.loading import load

ROOT = Path(__file__).resolve().parents[2]
PACKAGES = (
    "benchmarks", "comfort", "controller", "detector", "files", "foreride", "preview", "road", "scenarios",
    "vehicle",
)  # fmt: skip
PAGES = [
    *ROOT.glob("*.md"),
    *(page for folder in ("docs", "examples", "detector") for page in (ROOT / folder).rglob("*.md")),
]
OF_OLD_NAMES = ("CHANGELOG.md", "migration.md")
WRITTEN = [page for page in PAGES if page.name not in OF_OLD_NAMES and "reference" not in page.parts]
MODULES = [path for folder in (*PACKAGES, "docs", "examples") for path in (ROOT / folder).rglob("*.py")]
PATH = re.compile(r"[\w./-]+/[\w.-]+\.(py|md|yaml|csv|toml)")
DOTTED = re.compile(rf"(?:foreride\.)?(?:{'|'.join(PACKAGES)})(?:\.\w+)+")
ELSEWHERE = ("path/to/", "runs/", "data/", "photos/", "build/", "vibration/")
"""Folders of the reader's own, or of another project."""


def text_of(path: Path) -> str:
    """A page, or the docstrings and other longer texts of a module."""
    text = path.read_text(encoding="utf-8")
    if path.suffix != ".py":
        return re.sub(r"^```\w*\n.*?^```", "", text, flags=re.MULTILINE | re.DOTALL)
    literals = (node.value for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Constant))
    return "\n".join(literal for literal in literals if isinstance(literal, str) and len(literal) > 15)


def spans(path: Path) -> Iterator[str]:
    yield from re.findall(r"`([^`\s]+)`", text_of(path))


def is_module(dotted: str) -> bool:
    """Whether a dotted name is a package, a module, or a name that stands in a module's text."""
    if dotted.removeprefix("foreride.") in foreride.__all__:
        return True
    place, _, name = dotted.removeprefix("foreride.").rpartition(".")
    module = ROOT / place.replace(".", "/") / name
    if module.is_dir() or module.with_suffix(".py").is_file():
        return True
    if (ROOT / "foreride" / f"{name}.py").is_file() and not place:
        return True
    owner = module.parent / "__init__.py" if module.parent.is_dir() else module.parent.with_suffix(".py")
    return owner.is_file() and re.search(rf"\b{name}\b", owner.read_text()) is not None


def is_field(dotted: str) -> bool:
    """Whether a dotted name is a field of a scenario, down to the first list."""
    block: Any = load("mixed_40").mapping
    for name in dotted.split("."):
        if isinstance(block, list):
            return name.isdigit()
        if not isinstance(block, dict) or name not in block:
            return False
        block = block[name]
    return True


@pytest.mark.parametrize("path", [*WRITTEN, *MODULES], ids=lambda path: str(path.relative_to(ROOT)))
def test_files_and_modules_that_are_named_exist(path: Path) -> None:
    for span in spans(path):
        if PATH.fullmatch(span) and not span.startswith(ELSEWHERE):
            assert (ROOT / span).exists() or (path.parent / span).exists(), span
        elif DOTTED.fullmatch(span) and not span.endswith((".json", ".py", ".yaml")):
            assert is_module(span) or is_field(span), span


@pytest.mark.parametrize("page", WRITTEN, ids=lambda path: str(path.relative_to(ROOT)))
def test_links_lead_somewhere(page: Path) -> None:
    for link in re.findall(r"\]\(([^)#:\s]+)(?:#[\w-]+)?\)", page.read_text(encoding="utf-8")):
        assert "reference/" in link or (page.parent / link).exists(), link


def test_the_new_place_of_every_old_import_exists() -> None:
    page = (ROOT / "docs" / "migration.md").read_text()
    rows = re.findall(r"^\| `([\w.]+)` \| `([\w.]+)` \|", page, re.MULTILINE)
    assert len(rows) > 200
    assert not [new for _, new in rows if not is_module(new)]
