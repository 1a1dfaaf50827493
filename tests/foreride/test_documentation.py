"""The pages on the library and on extensions show every public name."""

import re
from pathlib import Path

import foreride

DOCS = Path(__file__).resolve().parents[2] / "docs"
LIBRARY = DOCS / "library.md"


def examples(page: Path) -> str:
    return "\n".join(re.findall(r"^```python\n(.*?)^```", page.read_text(), re.MULTILINE | re.DOTALL))


def test_every_public_name_has_an_example() -> None:
    shown = set(re.findall(r"foreride\.(\w+)", examples(LIBRARY)))
    shown |= set(re.findall(r"\bregister_\w+(?=\(|\n@)", examples(DOCS / "extending.md")))
    described = {"Controller", "Comparison", "Result"}  # which name types, and stand in the text
    assert set(foreride.__all__) - described == shown
    assert "foreride.Controller" in LIBRARY.read_text()
