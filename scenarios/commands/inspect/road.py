"""`foreride road`: length, roughness and features of a scenario's road or of a road file."""

import argparse
import os
from collections.abc import Sequence
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rich.table import Table

from foreride.files.own_code import say_once
from foreride.files.reading.numbers import within
from foreride.files.writing.atomic import write_text
from foreride.road.io.formats import FORMATS
from foreride.road.io.plausibility import doubts
from foreride.road.io.raw_profile import TRACK_M
from foreride.road.io.reading_options import ReadingOptions
from foreride.road.io.surface_file import MeasuredSurface, read_surface
from foreride.road.io.writing import write_surface
from foreride.road.summary import (
    SEGMENTS_M,
    STEP_M,
    Track,
    TrackSummary,
    list_features,
    measured_tracks,
    road_track,
    segments,
    summarise,
)
from foreride.scenarios.commands.console import console
from foreride.scenarios.commands.options import add_json_option
from foreride.scenarios.definition.doubts import doubts_of_scenario
from foreride.scenarios.definition.loading import load
from foreride.scenarios.report.figures.files import save
from foreride.scenarios.report.figures.road import road_figure
from foreride.scenarios.runs.write import to_json

Array = NDArray[np.float64]
MOST_ROWS = 25
"""Most segments that are printed; `--json` and `--plot` have all."""
_UNITS = ("m", "cm", "mm", "um", "in", "ft", "km")


def configure(command: argparse.ArgumentParser) -> None:
    """Add the options, and the function to execute."""
    endings = ", ".join(FORMATS)
    command.add_argument("road", help=f"a scenario (name or YAML file), or a road file ({endings})")
    add_reading_options(command)
    command.add_argument("--write", type=Path, metavar="FILE", help="write the road as .csv or .crg")
    command.add_argument("--step", type=float, metavar="M", help="spacing of the stations of --write")
    command.add_argument("--plot", type=Path, metavar="FILE.png", help="draw heights and IRI of segments")
    add_json_option(command)
    command.set_defaults(execute=execute)


def add_reading_options(command: argparse.ArgumentParser) -> None:
    """Add the options for a road file that differs from the conventions."""
    group = command.add_argument_group("reading a road file (see `road.reading` in the scenario reference)")
    group.add_argument("--unit", choices=_UNITS, help="unit of the heights")
    group.add_argument("--x-unit", choices=_UNITS, help="unit of the stations")
    group.add_argument("--decimal", choices=(".", ","), help="decimal mark")
    group.add_argument("--separator", choices=(",", ";", "tab", "space"), help="separator of the columns")
    group.add_argument("--reversed", action="store_true", help="drive towards falling stations")
    group.add_argument(
        "--speed", type=float, metavar="KMH", dest="speed_kmh", help="stations are times at this speed"
    )
    for name, told in (("x", "stations"), ("z", "heights"), ("left", "left track"), ("right", "right track")):
        group.add_argument(f"--{name}", metavar="COLUMN", help=f"name of the column of the {told}")
    group.add_argument("--cell", type=float, metavar="M", dest="cell_m", help="cell of a point cloud's grid")


def reading_options(arguments: argparse.Namespace) -> ReadingOptions:
    """Reading options given on the command line."""
    return ReadingOptions(**{item.name: getattr(arguments, item.name) for item in fields(ReadingOptions)})


def execute(arguments: argparse.Namespace) -> int:
    """Print a table of the wheel tracks, of their segments and of the features."""
    length_m, tracks, features, said = _subject(arguments)
    for doubt in said:
        say_once(f"{arguments.road} {doubt}", f"{arguments.road}: {doubt}")
    summaries = [summarise(track) for track in tracks]
    console.print(f"{arguments.road}: {length_m:g} m, stations every {tracks[0].step_m:.4g} m")
    console.print(_track_table(summaries))
    parts = {f"{length:g}": [segments(track, length) for track in tracks] for length in SEGMENTS_M}
    for length, by_track in parts.items():
        if by_track[0]:
            console.print(_segment_table(length, tracks, by_track))
    if features:
        console.print(_feature_table(features))
    if arguments.write:
        write_surface(arguments.write, *_sampled(arguments))
    if arguments.plot:
        save(road_figure(tracks), arguments.plot)
    if arguments.json:
        document = {"schema": 1, "length_m": length_m, "features": features, "notes": list(said)}
        document["tracks"] = [asdict(summary) for summary in summaries]
        document["segments"] = {
            length: [[part._asdict() for part in track] for track in by_track]
            for length, by_track in parts.items()
        }
        write_text(arguments.json, to_json(document) + "\n")
    return 0


def _subject(
    arguments: argparse.Namespace,
) -> tuple[float, list[Track], list[dict[str, object]], Sequence[str]]:
    """Length, wheel tracks, features and doubts of a scenario's road or of a road file."""
    if _is_road_file(arguments.road):
        surface = read_surface(arguments.road, reading_options(arguments))
        wheel_y_m = (TRACK_M / 2, -TRACK_M / 2)
        covered = _inside(surface, wheel_y_m)
        said = tuple(doubts(surface, wheel_y_m))
        return surface.length_m, measured_tracks(surface, covered), [], said
    scenario = load(arguments.road)
    half, road = scenario.vehicle.parameters.track_m / 2, scenario.road
    tracks = [road_track(road, y_m) for y_m in (half, -half)]
    return road.length_m, tracks, list_features(road), doubts_of_scenario(scenario)


def _sampled(arguments: argparse.Namespace) -> tuple[Array, Array, Array]:
    """Stations, lines and heights to write: those of a file, or a grid that holds the wheels' lines."""
    if arguments.step is not None:
        within("--step", arguments.step, 0.005, 0.5, "m")
    if _is_road_file(arguments.road):
        surface = read_surface(arguments.road, reading_options(arguments))
        if arguments.step is None:
            return surface.x_m, surface.y_m, surface.heights
        x = _stations(surface.length_m, arguments.step)
        return x, surface.y_m, surface.height(x, surface.y_m[:, None])
    scenario = load(arguments.road)
    x = _stations(scenario.road.length_m, arguments.step or STEP_M)
    y = scenario.vehicle.parameters.track_m / 8 * np.arange(-6.0, 7.0)
    return x, y, scenario.road.height(x, y[:, None])


def _stations(length_m: float, step_m: float) -> Array:
    return step_m * np.arange(int(length_m / step_m + 1e-9) + 1, dtype=np.float64)


def _is_road_file(name: str) -> bool:
    """Whether the argument is a file that is no scenario."""
    suffix = Path(name).suffix.lower()
    return suffix in FORMATS or (suffix not in (".yaml", ".yml") and os.path.isfile(name))


def _inside(surface: MeasuredSurface, wheel_y_m: Sequence[float]) -> list[float]:
    """Wheel tracks moved to the border of a surface that does not reach them."""
    if len(surface.y_m) == 1:
        return list(wheel_y_m)
    low, high = float(surface.y_m[0]), float(surface.y_m[-1])
    return list(dict.fromkeys(min(max(y_m, low), high) for y_m in wheel_y_m))


def _track_table(tracks: list[TrackSummary]) -> Table:
    table = Table(
        "wheel track", "range mm", "IRI m/km", "G_d(0.1) 1e-6 m³ (90 %)", "waviness", "ISO 8608 class (90 %)"
    )
    for track in tracks:
        side = "left" if track.y_m > 0 else "right"
        table.add_row(
            f"{side}, y = {track.y_m:g} m",
            f"{track.range_m * 1e3:.1f}",
            "-" if track.iri_m_km is None else f"{track.iri_m_km:.2f}",
            _level(track),
            "-" if track.waviness is None else f"{track.waviness:.2f}",
            track.iso_class or "-",
        )
    return table


def _level(track: TrackSummary) -> str:
    if track.psd_n0_m3 is None or track.psd_low_m3 is None or track.psd_high_m3 is None:
        return "-"
    return f"{track.psd_n0_m3 * 1e6:.3g} ({track.psd_low_m3 * 1e6:.3g} ... {track.psd_high_m3 * 1e6:.3g})"


def _segment_table(length: str, tracks: Sequence[Track], by_track: Sequence[Sequence[Any]]) -> Table:
    columns = [f"IRI m/km, y = {track.y_m:g} m" for track in tracks]
    table = Table(f"{length} m segment", *columns)
    rows = list(zip(*by_track, strict=True))
    for row in rows[:MOST_ROWS]:
        table.add_row(f"{row[0].start_m:g} ... {row[0].end_m:g} m", *(f"{part.iri_m_km:.2f}" for part in row))
    if len(rows) > MOST_ROWS:
        table.add_row(f"and {len(rows) - MOST_ROWS} more", *(["--json, --plot"] * len(tracks)))
    return table


def _feature_table(features: list[dict[str, object]]) -> Table:
    table = Table("feature", "from m", "to m", "dimensions")
    for feature in features:
        sizes = {key: value for key, value in feature.items() if key not in ("kind", "start_m", "end_m")}
        text = ", ".join(f"{key} {value:g}" for key, value in sizes.items() if isinstance(value, int | float))
        table.add_row(str(feature["kind"]), f"{feature['start_m']:g}", f"{feature['end_m']:g}", text)
    return table
