"""Tests of the surveyed map of a random event: close to the road, and only for drives with a map."""

import numpy as np
import pytest

from foreride.preview.prior_drives.road_map import read
from foreride.scenarios.random_roads.events import event_scenario
from foreride.scenarios.random_roads.survey_map import HEIGHT_SIGMA_M, surveyed

EVENT = 1001


def test_the_map_is_the_road_with_the_error_of_a_survey() -> None:
    scenario = event_scenario(EVENT)
    with surveyed(scenario, "map", EVENT) as mapped:
        assert mapped.map is not None
        surface = read(mapped.map.file).surface
    y = scenario.vehicle.parameters.wheel_y_m[0]
    error = surface.height(surface.x_m, y) - scenario.road.height(surface.x_m, y)
    assert error.std() == pytest.approx(HEIGHT_SIGMA_M, rel=0.2)
    with surveyed(scenario, "map", EVENT) as again:
        assert again.map is not None
        assert np.array_equal(
            read(again.map.file).surface.height(surface.x_m, y), surface.height(surface.x_m, y)
        )


def test_other_perceptions_drive_the_event_as_it_is() -> None:
    scenario = event_scenario(EVENT)
    with surveyed(scenario, "lidar_64", EVENT) as driven:
        assert driven is scenario
