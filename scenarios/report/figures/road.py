"""Figure of a road: height along the wheel tracks, and IRI in segments."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from foreride.road.summary import SEGMENTS_M, Track, segments
from foreride.scenarios.report.figures.files import WIDTH_IN, styled

_COLOURS = ("#1c6ebe", "#c98a1b")
_MAX_POINTS = 20_000


def road_figure(tracks: Sequence[Track]) -> Figure:
    """Figure of the tracks of one road: height, and the IRI of each length of segments."""
    with styled():
        figure = Figure(figsize=(WIDTH_IN, 1.6 * (1 + len(SEGMENTS_M))), layout="constrained")
        axes = figure.subplots(1 + len(SEGMENTS_M), 1, sharex=True)
        for track, colour in zip(tracks, _COLOURS, strict=False):
            label = f"y = {track.y_m:g} m"
            thin = max(1, len(track.heights) // _MAX_POINTS)
            x = track.start_m + track.step_m * np.arange(len(track.heights))
            axes[0].plot(x[::thin], 1e3 * track.heights[::thin], color=colour, label=label, linewidth=0.8)
            for axis, length_m in zip(axes[1:], SEGMENTS_M, strict=True):
                parts = segments(track, length_m)
                if parts:
                    edges = [*(part.start_m for part in parts), parts[-1].end_m]
                    axis.stairs([part.iri_m_km for part in parts], edges, color=colour)
                axis.set_ylabel(f"IRI, {length_m:g} m\n(m/km)")
                axis.set_ylim(bottom=0.0)
        axes[0].set_ylabel("height (mm)")
        axes[0].legend(loc="upper right", ncols=2)
        axes[-1].set_xlabel("distance (m)")
    return figure
