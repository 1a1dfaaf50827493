"""Test that the cells of the example notebook run in order, as a reader would run them."""

import ast
import json
from pathlib import Path
from typing import Any

import pytest

NOTEBOOK = Path(__file__).resolve().parents[2] / "examples" / "library.ipynb"


def run_cell(source: str, namespace: dict[str, Any]) -> Any:
    """Value of the cell's last expression, which a notebook shows."""
    tree = ast.parse(source)
    last = tree.body.pop() if isinstance(tree.body[-1], ast.Expr) else None
    exec(compile(tree, "cell", "exec"), namespace)
    return None if last is None else eval(compile(ast.Expression(last.value), "cell", "eval"), namespace)


def test_the_notebook_runs_and_shows_its_results(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    namespace: dict[str, Any] = {"__name__": "__main__"}
    cells = json.loads(NOTEBOOK.read_text())["cells"]
    sources = ["".join(cell["source"]) for cell in cells if cell["cell_type"] == "code"]
    values = [value for source in sources if (value := run_cell(source, namespace)) is not None]
    pages = [page() for value in values if (page := getattr(value, "_repr_html_", None))]
    assert len(pages) == 3  # a drive, statistics of its signals, a comparison
    assert all("<table" in page for page in pages)
    assert not any(cell.get("outputs") for cell in cells), "commit the notebook without outputs"
