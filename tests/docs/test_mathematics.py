"""Tests that all formulas of the documentation are rendered without a script and without the network."""

import importlib.util
import re
from pathlib import Path

import pytest
from docutils.utils.math.latex2mathml import tex2mathml

DOCS = Path(__file__).resolve().parents[2] / "docs"
CODE = re.compile(r"^```.*?^```|`[^`\n]*`", re.MULTILINE | re.DOTALL)
FORMULA = re.compile(r"\$\$(.+?)\$\$|\$([^$\n]+?)\$", re.DOTALL)


def formulas(page: Path) -> list[str]:
    text = CODE.sub("", page.read_text(encoding="utf-8"))
    return [displayed or inline for displayed, inline in FORMULA.findall(text)]


@pytest.mark.parametrize("page", sorted(DOCS.rglob("*.md")), ids=lambda page: page.stem)
def test_each_formula_becomes_mathml(page: Path) -> None:
    for formula in formulas(page):
        assert tex2mathml(formula).startswith("<math"), formula


def test_the_pages_with_equations_have_formulas() -> None:
    assert len(formulas(DOCS / "equations.md")) > 60
    assert formulas(DOCS / "dampers.md")


def test_the_settings_name_the_renderer_that_needs_no_script() -> None:
    spec = importlib.util.spec_from_file_location("conf", DOCS / "conf.py")
    assert spec is not None
    assert spec.loader is not None
    settings = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(settings)
    assert settings.html_math_renderer == "mathml"
    assert not any("mathjax" in name for name in settings.extensions)
