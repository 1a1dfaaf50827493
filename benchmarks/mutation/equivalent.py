"""Mutants that are equivalent to the code: no test can notice them. They are counted apart."""

from pathlib import Path
from typing import Any

import yaml

LISTED = Path(__file__).with_name("equivalent.yaml")
"""List of {file, text, change, reason}: `text` is the line of the source without its indentation."""


def reason(root: Path, row: dict[str, Any]) -> str | None:
    """Reason why a mutant is equivalent to the code, None for one that is not known to be."""
    text = (root / row["file"]).read_text().splitlines()[row["line"] - 1].strip()
    for entry in yaml.safe_load(LISTED.read_text()):
        if (entry["file"], entry["text"], entry["change"]) == (row["file"], text, row["change"]):
            return str(entry["reason"])
    return None
