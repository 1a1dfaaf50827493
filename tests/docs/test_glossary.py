"""Tests of the glossary: every term once, in order, and names that stand in the code."""

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PACKAGES = ("comfort", "controller", "detector", "files", "preview", "road", "scenarios", "vehicle")
PAGE = (ROOT / "docs" / "glossary.md").read_text(encoding="utf-8")
SECTIONS = re.split(r"^## ", PAGE, flags=re.MULTILINE)[1:]
TERM = re.compile(r"^\* \*\*(.+?)\*\*", re.MULTILINE)


def test_axes_come_first_and_every_other_section_is_in_alphabetical_order() -> None:
    axes, *others = SECTIONS
    assert axes.startswith("Axes")
    for section in others:
        terms = [term.lower() for term in TERM.findall(section)]
        assert terms
        assert terms == sorted(terms), section.splitlines()[0]


def test_every_term_is_explained_once() -> None:
    terms = [term.lower() for term in TERM.findall(PAGE)]
    assert len(terms) > 150
    assert len(terms) == len(set(terms))


def test_names_of_the_glossary_stand_in_the_code() -> None:
    files = (path for package in PACKAGES for path in (ROOT / package).rglob("*.py"))
    words = {word for path in files for word in re.findall(r"\w+", path.read_text(encoding="utf-8"))}
    names = set(re.findall(r"`([A-Za-z_]\w+)`", PAGE)) - {"code"}
    assert len(names) > 50
    assert names <= words, names - words
