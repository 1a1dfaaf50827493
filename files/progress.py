"""Progress of a long run: a bar with the time left on a terminal, elsewhere a line at intervals."""

import sys
import time
from types import TracebackType
from typing import Any


class Progress:
    """Progress display of `total` image passes, from `start` on."""

    def __init__(self, total: int, start: int = 0, every_s: float = 20.0):
        self.total, self.start, self.every_s = total, start, every_s
        self.started_at = self.reported_at = time.monotonic()
        self.bar = _bar(total) if sys.stderr.isatty() else None

    def __enter__(self) -> "Progress":
        if self.bar:
            self.bar.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self.bar:
            self.bar.stop()

    def show(self, done: int, note: str) -> None:
        """Update the display to `done` passes."""
        if self.bar:
            self.bar.update(self.bar.task_ids[0], completed=done, description=note)
        elif time.monotonic() - self.reported_at > self.every_s:
            self.reported_at = time.monotonic()
            rate = (done - self.start) / (self.reported_at - self.started_at)
            minutes_left = (self.total - done) / rate / 60
            print(
                f"{done}/{self.total} passes, {rate:.1f}/s, {minutes_left:.0f} min left, {note}", flush=True
            )


def _bar(total: int) -> Any:
    try:
        from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeRemainingColumn
        from rich.progress import Progress as Bar
    except ImportError:
        return None
    from rich.console import Console

    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    bar = Bar(*columns, console=Console(stderr=True))
    bar.add_task("starting", total=total)
    return bar
