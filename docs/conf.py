"""Sphinx settings: `make docs` builds the site into build/docs."""

from importlib import metadata
from pathlib import Path
from typing import Any

from foreride.scenarios import reference_docs

project = "foreride"
release = metadata.version("foreride")
author = copyright = "foreride contributors"

extensions = ["myst_parser"]
myst_enable_extensions = ["colon_fence", "dollarmath"]
myst_heading_anchors = 3
exclude_patterns = ["build"]
suppress_warnings = ["myst.header"]

html_theme = "furo"
html_title = "foreride"
html_static_path: list[str] = []
html_show_sphinx = False


def setup(app: Any) -> None:
    """Make the reference pages from the code before they are read."""
    app.connect("builder-inited", lambda app: reference_docs.write(Path(app.srcdir) / "reference"))
