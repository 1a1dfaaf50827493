"""Signal plots with a moving time cursor, for the video."""

from collections.abc import Sequence

import cv2
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from foreride.scenarios.definition.clock import TICKS_PER_SECOND
from foreride.scenarios.report.labels import plain
from foreride.scenarios.report.window import event_window
from foreride.scenarios.simulation.simulate import Run

Labelled = tuple[str, Run, tuple[int, int, int]]

_DPI = 100
_PANELS = (
    ("seat_acc_0", 1.0, "body acceleration, front seat (m/s²)"),
    ("damping_0", 1e-3, "front damping (kN·s/m)"),
    ("tyre_force_0", 1e-3, "front tyre load (kN)"),
)


class Traces:
    """Body acceleration, damping and tyre load of some runs, drawn once; `at` adds the cursor."""

    def __init__(self, runs: Sequence[Labelled], width_px: int, height_px: int) -> None:
        self.window = event_window(runs[0][1])
        figure = Figure(figsize=(width_px / _DPI, height_px / _DPI), dpi=_DPI, layout="constrained")
        canvas = FigureCanvasAgg(figure)
        axes = figure.subplots(1, len(_PANELS))
        part = slice(*self.window)
        for axis, (signal, factor, title) in zip(axes, _PANELS, strict=True):
            for label, run, colour in runs:
                rgb = tuple(channel / 255 for channel in colour)
                axis.plot(
                    run.signals["time_s"][part],
                    run.signals[signal][part] * factor,
                    color=rgb,
                    label=plain(label),
                )
            axis.set_title(title, fontsize=10)
            axis.set_xlabel("time (s)", fontsize=9)
            axis.tick_params(labelsize=8)
            axis.grid(alpha=0.25)
            axis.set_xlim(*(tick / TICKS_PER_SECOND for tick in self.window))
        axes[0].legend(fontsize=8, loc="upper right")
        canvas.draw()
        self._image = np.asarray(canvas.buffer_rgba())[..., :3].copy()
        self._frames = [axis.get_window_extent() for axis in axes]

    def at(self, tick: int) -> np.ndarray:
        """Return the panels as an RGB image (height_px, width_px, 3), with a line at `tick`."""
        image = self._image.copy()
        start, end = self.window
        for frame in self._frames:
            column = round(frame.x0 + (tick - start) / max(end - start, 1) * frame.width)
            top, bottom = round(image.shape[0] - frame.y1), round(image.shape[0] - frame.y0)
            cv2.line(image, (column, top), (column, bottom), (200, 60, 40), 1, cv2.LINE_AA)
        return image
