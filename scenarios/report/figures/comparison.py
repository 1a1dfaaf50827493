"""Figures of a comparison, drive by drive while it runs, then its overview."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from foreride.files.writing.names import component
from foreride.scenarios.comparison.statistics import Row
from foreride.scenarios.report.figures.damper import damper_figure
from foreride.scenarios.report.figures.drive import drive_figure
from foreride.scenarios.report.figures.files import PAPER, save
from foreride.scenarios.report.figures.overview import Drive, Excerpt, excerpt, overview_figure
from foreride.scenarios.report.figures.spectrum import spectrum_figure
from foreride.scenarios.report.labels import drive_of
from foreride.scenarios.simulation.simulate import Run

FOLDER = "figures"
_KINDS = {"signals": drive_figure, "spectrum": spectrum_figure, "damper": damper_figure}


class ComparisonFigures:
    """Figures of a comparison below `out`: three of each drive as its runs come in, one of all drives.

    Runs come in drive by drive, all seeds of one together; the signals of one drive are held at a time.
    """

    def __init__(self, out: Path):
        self._folder = out / FOLDER
        self._runs: list[Run] = []
        self._excerpts: dict[Drive, Excerpt] = {}

    def add(self, run: Run) -> None:
        """Take a run; the figures of the drive before it are written when a new drive begins."""
        if self._runs and drive_of(self._runs[0]) != drive_of(run):
            self._finish_drive()
        self._runs.append(replace(run, looks=[]))

    def finish(self, rows: Sequence[Row], baseline: str | None) -> Path:
        """Write what is left, with the overview; return the folder."""
        self._finish_drive()
        save(overview_figure(rows, self._excerpts, baseline), self._folder / "overview", PAPER)
        return self._folder

    def _finish_drive(self) -> None:
        self._folder.mkdir(exist_ok=True)
        name = component(self._runs[0].case.scenario.name)
        for kind, figure in _KINDS.items():
            save(figure(self._runs), self._folder / f"{name}-{kind}", PAPER)
        self._excerpts[drive_of(self._runs[0])] = excerpt(self._runs)
        self._runs = []
