"""Writing of figures as PNG, PDF and SVG files."""

import io
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from matplotlib import rc_context
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from foreride.files.writing.atomic import write_bytes

PAPER = ("png", "pdf", "svg")
WIDTH_IN = 6.4
"""Width of a figure: its 10-point text is legible across a phone and across a column of a paper."""
_METADATA: dict[str, dict[str, Any]] = {
    "png": {"Software": None},
    "pdf": {"CreationDate": None, "Producer": None, "Creator": None},
    "svg": {"Date": None, "Creator": None},
}
_STYLE: dict[Any, Any] = {
    "font.size": 10, "axes.titlesize": 10, "axes.labelsize": 9, "xtick.labelsize": 9, "ytick.labelsize": 9,
    "legend.fontsize": 9, "legend.frameon": False, "axes.grid": True, "grid.alpha": 0.25,
    "axes.spines.top": False, "axes.spines.right": False, "lines.linewidth": 1.3,
    "pdf.fonttype": 42, "svg.hashsalt": "foreride", "svg.fonttype": "path",
}  # fmt: skip


@contextmanager
def styled() -> Iterator[None]:
    """Matplotlib settings of all figures."""
    with rc_context(_STYLE):
        yield


def save(figure: Figure, path: Path, formats: Sequence[str] = ("png",)) -> list[Path]:
    """Write a figure as `path` with its suffix replaced by each format, atomically; return the files."""
    files = [path.parent / f"{path.name.removesuffix('.png')}.{kind}" for kind in formats]
    for file, data in zip(files, encoded(figure, formats), strict=True):
        write_bytes(file, data)
    return files


def encoded(figure: Figure, formats: Sequence[str] = ("png",)) -> Iterator[bytes]:
    """Content of the file of a figure in each format."""
    FigureCanvasAgg(figure)
    figure.draw_without_rendering()
    figure.set_layout_engine("none")  # the same layout in each format, computed once
    for kind in formats:
        buffer = io.BytesIO()
        with rc_context(_STYLE):
            figure.savefig(buffer, format=kind, dpi=110, metadata=_METADATA[kind])
        yield buffer.getvalue()
