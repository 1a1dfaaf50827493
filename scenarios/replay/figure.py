"""Figure of a replay: preview over time and distance ahead, existence of the boxes' objects, and speed."""

import numpy as np
from matplotlib.figure import Figure

from foreride.detector.detections import CLASS_NAMES
from foreride.scenarios.replay.playback import Replay
from foreride.scenarios.replay.recording import Signals
from foreride.scenarios.report.figures.files import WIDTH_IN, styled

_COLOURS = ("#1c6ebe", "#c98a1b")
_LEAST_SCALE_MM = 20.0
_MAX_POINTS = 5_000


def replay_figure(result: Replay, signals: Signals) -> Figure:
    """Figure of a replay: height previewed at the right front wheel, scores of boxes, and speed."""
    with styled():
        figure = Figure(figsize=(WIDTH_IN, 5.4), layout="constrained")
        preview, scores, speed = figure.subplots(3, 1, sharex=True, height_ratios=(3, 1, 1))
        log = result.previews
        height_mm = 1e3 * log.height_m.T
        scale = max(_LEAST_SCALE_MM, float(np.abs(height_mm).max(initial=0.0)))
        mesh = preview.pcolormesh(
            log.time_s, log.distance_m, height_mm, cmap="RdBu_r", vmin=-scale, vmax=scale, rasterized=True
        )
        figure.colorbar(mesh, ax=preview, label="previewed height (mm)")
        preview.set_ylabel("distance ahead of\nthe right front wheel (m)")
        for cls, (name, colour) in enumerate(zip(CLASS_NAMES, _COLOURS, strict=False)):
            points = [
                (look.time_s, score)
                for look in result.looks
                for score, found in zip(look.detections.scores, look.detections.classes, strict=True)
                if found == cls
            ]
            scores.plot(*np.array(points).reshape(-1, 2).T, ".", color=colour, label=name.replace("_", " "))
        scores.set_ylim(0.0, 1.0)
        scores.set_ylabel("score of boxes")
        scores.legend(loc="lower right", ncols=2)
        thin = max(1, len(signals.times_s) // _MAX_POINTS)
        speed.plot(signals.times_s[::thin], 3.6 * signals.values["speed_m_s"][::thin], color="#444444")
        speed.set_ylim(bottom=0.0)
        speed.set_ylabel("speed (km/h)")
        speed.set_xlabel("time (s)")
        speed.set_xlim(0.0, signals.times_s[-1])
    return figure
