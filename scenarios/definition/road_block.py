"""Road block of a scenario file: defaults from its surface file and from the car."""

import os
from pathlib import Path
from typing import Any

from foreride.files.reading import strict
from foreride.road.io.reading_options import ReadingOptions
from foreride.road.io.surface_file import read_surface


def fill_in(road: Any, folder: Path, track_m: Any) -> Any:
    """Return the block with its file found beside the scenario, and file length and car track as defaults.

    Malformed entries are left to the validation. Raises InputError for an unreadable file.
    """
    if not isinstance(road, dict):
        return road
    filled = dict(road)
    if isinstance(filled.get("file"), str):
        local_file = folder / filled["file"]
        filled["file"] = str(local_file) if os.path.isfile(local_file) else filled["file"]
        options = None
        if filled.get("reading") is not None:
            options = strict.structure(ReadingOptions, filled["reading"], "reading")
        filled.setdefault("length_m", read_surface(filled["file"], options).length_m)
    track = {"track_m": track_m} if isinstance(track_m, int | float) else {}
    if isinstance(filled.get("roughness"), dict):
        filled["roughness"] = track | filled["roughness"]
    if isinstance(filled.get("chains"), list):
        filled["chains"] = [track | chain if isinstance(chain, dict) else chain for chain in filled["chains"]]
    return filled
