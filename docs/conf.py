"""Sphinx settings: `make docs` builds the site into build/docs."""

from importlib import metadata
from pathlib import Path
from typing import Any, NoReturn

from docutils import nodes
from docutils.utils.math.latex2mathml import tex2mathml

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


html_math_renderer = "mathml"


def inline_math(translator: Any, node: nodes.Node) -> NoReturn:
    """Write a formula as MathML, which browsers display without a script."""
    translator.body.append(tex2mathml(node.astext()))
    raise nodes.SkipNode


def block_math(translator: Any, node: nodes.Node) -> NoReturn:
    """Write a displayed formula as MathML."""
    translator.body.append(
        f'<div class="math" style="overflow: auto hidden">{tex2mathml(node.astext(), as_block=True)}</div>'
    )
    raise nodes.SkipNode


def setup(app: Any) -> None:
    """Render mathematics as MathML; make the reference pages from the code before they are read."""
    app.add_html_math_renderer("mathml", (inline_math, None), (block_math, None))
    app.connect("builder-inited", lambda app: reference_docs.write(Path(app.srcdir) / "reference"))
