"""Signal plots with a moving time cursor, for the film."""

from collections.abc import Sequence

import cv2
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

from foreride.scenarios.definition.clock import TICKS_PER_SECOND
from foreride.scenarios.report.figures.ensemble import Ensemble
from foreride.scenarios.report.figures.files import styled
from foreride.scenarios.report.labels import acceleration_label, wheel_label

_DPI = 100
_CURSOR = (208, 58, 43)
_RECT = (0.006, 0.01, 0.98, 0.98)
"""Part of the picture (left, bottom, width, height) that the plots may fill."""


class Traces:
    """Acceleration, damping and tyre load of some runs in a window of ticks; `at` adds the cursor."""

    def __init__(self, groups: Sequence[Ensemble], window: tuple[int, int], size_px: tuple[int, int]) -> None:
        self._window = window
        width, height = size_px
        with styled():
            figure = Figure(
                figsize=(width / _DPI, height / _DPI), dpi=_DPI, layout=ConstrainedLayoutEngine(rect=_RECT)
            )
            canvas = FigureCanvasAgg(figure)
            axes = figure.subplots(1, 3)
            car = groups[0].runs[0].case.scenario.vehicle.parameters
            panels = (
                ("seat_acc_0", 1.0, acceleration_label(car) + " (m/s²)"),
                ("damping_0", 1e-3, wheel_label(car, 0, "damping") + " (kN·s/m)"),
                ("tyre_force_0", 1e-3, wheel_label(car, 0, "tyre load") + " (kN)"),
            )
            part = slice(*window)
            for axis, (signal, factor, title) in zip(axes, panels, strict=True):
                for group in groups:
                    time = group.runs[0].signals["time_s"][part]
                    group.line.draw(axis, time, group.signal(signal, part, factor))
                axis.set_title(title, loc="left")
                axis.set_xlabel("time (s)")
                axis.set_xlim(*(tick / TICKS_PER_SECOND for tick in window))
            handles, labels = axes[0].get_legend_handles_labels()
            figure.legend(handles, labels, loc="outside upper center", ncols=len(labels), fontsize=11)
            canvas.draw()
        self._image = np.asarray(canvas.buffer_rgba())[..., :3].copy()
        self._frames = [axis.get_window_extent() for axis in axes]

    def at(self, tick: int) -> np.ndarray:
        """Return the panels as an RGB image, with a line at `tick`."""
        image = self._image.copy()
        start, end = self._window
        for frame in self._frames:
            column = round(frame.x0 + (tick - start) / max(end - start, 1) * frame.width)
            top, bottom = round(image.shape[0] - frame.y1), round(image.shape[0] - frame.y0)
            cv2.line(image, (column, top), (column, bottom), _CURSOR, 2, cv2.LINE_AA)
        return image
