"""Console output of the commands: tables, progress, and the hint at the next command."""

import shlex
import time
from collections.abc import Iterable, Iterator, Sized
from typing import Any, TypeVar

from rich.console import Console
from rich.progress import (
    BarColumn,
    Progress,
    TaskID,
    TaskProgressColumn,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)
from rich.text import Text

from foreride.files.command_line import notify

_FILE_WIDTH = 140
REPORT_EVERY_S = 20.0
"""Interval of the lines that report progress where there is no terminal, s."""
Item = TypeVar("Item")


class _Console(Console):
    """Console that leaves a broken pipe to the command line, which ends quietly."""

    def on_broken_pipe(self) -> None:
        raise


def _console() -> Console:
    """Console of the terminal; for a file or a pipe, wide enough for every column. Text is no markup."""
    terminal = _Console(markup=False, emoji=False)
    return terminal if terminal.is_terminal else _Console(width=_FILE_WIDTH, markup=False, emoji=False)


console = _console()


def verdict(passed: bool) -> Text:
    """Coloured result of a check."""
    return Text("ok    ", "green") if passed else Text("FAILED", "red")


def suggest(*words: object) -> None:
    """Print the command that usually comes next."""
    console.print(f"next: {shlex.join(map(str, words))}", highlight=False, soft_wrap=True)


class ReportedProgress(Progress):
    """Progress with the time left: a bar on a terminal, elsewhere a line on stderr at intervals."""

    def __init__(self, *columns: Any, **options: Any) -> None:
        super().__init__(*columns, **options)
        self._reported_at = time.monotonic()

    def update(self, task_id: TaskID, **changes: Any) -> None:
        """Update a task."""
        super().update(task_id, **changes)
        self._report(task_id)

    def advance(self, task_id: TaskID, advance: float = 1) -> None:
        """Advance a task."""
        super().advance(task_id, advance)
        self._report(task_id)

    def _report(self, task_id: TaskID) -> None:
        task, now = self._tasks[task_id], time.monotonic()
        if not self.disable or task.finished or now - self._reported_at < REPORT_EVERY_S:
            return
        self._reported_at = now
        remaining = "" if task.time_remaining is None else f", about {task.time_remaining:.0f} s left"
        notify(f"{task.percentage:.0f} % after {task.elapsed or 0:.0f} s{remaining}: {task.description}")


def progress_bar() -> ReportedProgress:
    """Transient progress display."""
    columns = (
        TextColumn("{task.description}", markup=False), BarColumn(), TaskProgressColumn(),
        TimeElapsedColumn(), TextColumn("left"), TimeRemainingColumn(),
    )  # fmt: skip
    return ReportedProgress(*columns, console=console, transient=True, disable=not console.is_terminal)


def tracked(items: Iterable[Item], description: str, total: int | None = None) -> Iterator[Item]:
    """Yield the items, `total` of them where they have no length, with a progress display."""
    with progress_bar() as progress:
        task = progress.add_task(description, total=len(items) if isinstance(items, Sized) else total)
        for item in items:
            yield item
            progress.advance(task)
