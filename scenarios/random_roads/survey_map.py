"""Surveyed map of a random event, for the perception `map`: heights of both tracks with an error of survey.

Mobile mapping measures the height of a road to some millimetres; a car finds its place on such a map to some
centimetres with a multi-frequency satellite receiver.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from foreride.files.writing.atomic import write_text
from foreride.scenarios.definition.schema import MapSetup, Scenario

STEP_M = 0.05
HEIGHT_SIGMA_M, LOCALISATION_SIGMA_M = 0.003, 0.05


@contextmanager
def surveyed(scenario: Scenario, perception: str, seed: int) -> Iterator[Scenario]:
    """The scenario, for the perception `map` with a map of its road that exists meanwhile."""
    if perception != "map" or scenario.map is not None:
        yield scenario
        return
    with TemporaryDirectory() as folder:
        path = Path(folder) / "survey.csv"
        write_text(path, _survey(scenario, np.random.default_rng([seed, 2])))
        yield replace(scenario, map=MapSetup(str(path), LOCALISATION_SIGMA_M))


def _survey(scenario: Scenario, rng: np.random.Generator) -> str:
    """Map of the wheel tracks as CSV."""
    x = np.arange(0.0, scenario.road.length_m, STEP_M)
    tracks = sorted(set(scenario.vehicle.parameters.wheel_y_m))
    heights = [
        scenario.road.height(x, np.full_like(x, y)) + HEIGHT_SIGMA_M * rng.standard_normal(len(x))
        for y in tracks
    ]
    head = ["x_m", *(f"y={y:.3f}" for y in tracks), "height_sigma_m", "position_sigma_m", "existence"]
    rows = (
        [f"{station:.3f}", *(f"{z:.5f}" for z in row), f"{HEIGHT_SIGMA_M}", "0", "1"]
        for station, *row in zip(x, *heights, strict=True)
    )
    return "".join(",".join(row) + "\n" for row in [head, *rows])
