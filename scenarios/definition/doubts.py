"""Doubts about a scenario and its results: valid, simulated, but unlike any car on any road.

Commands say them on stderr and run folders keep them in the manifest, as `notes`.
"""

from collections.abc import Mapping

from foreride.files.writing.sharing import shared_name
from foreride.road.io import plausibility as road_plausibility
from foreride.scenarios.definition.schema import Scenario
from foreride.vehicle import plausibility as vehicle_plausibility

MAX_USUAL_WK_RMS = 10.0
"""Largest weighted acceleration that is not doubted, m/s²; ISO 2631-1 calls 2 extremely uncomfortable."""


def doubts_of_scenario(scenario: Scenario) -> tuple[str, ...]:
    """Doubts about the car and the measured road of a scenario, each in one line."""
    car, road = scenario.vehicle.parameters, scenario.road
    lines = [
        f"vehicle {shared_name(scenario.vehicle.model)}: {text}" for text in vehicle_plausibility.doubts(car)
    ]
    if road.file is not None and road.measured is not None:
        found = road_plausibility.doubts(road.measured, car.wheel_y_m)
        lines += [f"road {shared_name(road.file)}: {text}" for text in found]
    return tuple(lines)


def doubts_of_metrics(metrics: Mapping[str, float]) -> tuple[str, ...]:
    """Doubts about the results of a drive, each in one line."""
    if (wk_rms := metrics["wk_rms"]) <= MAX_USUAL_WK_RMS:
        return ()
    return (f"wk_rms of {wk_rms:.3g} m/s² is more than occupants of a car survive; are the units right?",)
