"""The page on the library shows every public name."""

import re
from pathlib import Path

import foreride

PAGE = Path(__file__).resolve().parents[2] / "docs" / "library.md"


def test_every_public_name_has_an_example() -> None:
    examples = "\n".join(re.findall(r"^```python\n(.*?)^```", PAGE.read_text(), re.MULTILINE | re.DOTALL))
    shown = set(re.findall(r"foreride\.(\w+)", examples))
    described = {"Controller", "Comparison", "Result"}  # which name types, and stand in the text
    assert set(foreride.__all__) - described == shown
    assert "foreride.Controller" in PAGE.read_text()
