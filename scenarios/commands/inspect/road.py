"""`foreride road`: length, roughness and features of a scenario's road or a profile file."""

import argparse
from dataclasses import asdict
from pathlib import Path

from rich.table import Table

from foreride.files.writing.atomic import write_text
from foreride.road.io.formats import FORMATS
from foreride.road.io.surface_file import read_surface
from foreride.road.road import Road
from foreride.road.summary import TrackSummary, list_features, summarise_track
from foreride.scenarios.commands.console import console
from foreride.scenarios.commands.options import add_json_option
from foreride.scenarios.definition.loading import load
from foreride.scenarios.runs.write import to_json

TRACK_M = 1.5


def configure(command: argparse.ArgumentParser) -> None:
    """Add the options, and the function to execute."""
    command.add_argument("road", help="a scenario (name or YAML file), or a profile (.csv or .crg)")
    add_json_option(command)
    command.set_defaults(execute=execute)


def execute(arguments: argparse.Namespace) -> int:
    """Print a table of the wheel tracks and one of the features."""
    road, lateral_m = _road(arguments.road)
    tracks, features = [summarise_track(road, y) for y in lateral_m], list_features(road)
    console.print(f"{arguments.road}: {road.length_m:g} m")
    console.print(_track_table(tracks))
    if features:
        console.print(_feature_table(features))
    if arguments.json:
        document = {"schema": 1, "length_m": road.length_m, "features": features}
        write_text(arguments.json, to_json(document | {"tracks": [asdict(track) for track in tracks]}) + "\n")
    return 0


def _road(name: str) -> tuple[Road, list[float]]:
    """Road, and lateral positions of the wheel tracks."""
    if Path(name).suffix.lower() in FORMATS:
        return Road(read_surface(name).length_m, file=name), [TRACK_M / 2, -TRACK_M / 2]
    scenario = load(name)
    half = scenario.vehicle.parameters.track_m / 2
    return scenario.road, [half, -half]


def _track_table(tracks: list[TrackSummary]) -> Table:
    table = Table("wheel track", "range mm", "IRI m/km", "G_d(0.1) 1e-6 m³", "waviness", "ISO 8608 class")
    for track in tracks:
        side = "left" if track.y_m > 0 else "right"
        table.add_row(
            f"{side}, y = {track.y_m:g} m",
            f"{track.range_m * 1e3:.1f}",
            "-" if track.iri_m_km is None else f"{track.iri_m_km:.2f}",
            "-" if track.psd_n0_m3 is None else f"{track.psd_n0_m3 * 1e6:.3g}",
            "-" if track.waviness is None else f"{track.waviness:.2f}",
            track.iso_class or "-",
        )
    return table


def _feature_table(features: list[dict[str, object]]) -> Table:
    table = Table("feature", "from m", "to m", "dimensions")
    for feature in features:
        sizes = {key: value for key, value in feature.items() if key not in ("kind", "start_m", "end_m")}
        text = ", ".join(f"{key} {value:g}" for key, value in sizes.items() if isinstance(value, int | float))
        table.add_row(str(feature["kind"]), f"{feature['start_m']:g}", f"{feature['end_m']:g}", text)
    return table
