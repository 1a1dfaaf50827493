"""Tests of the shipped tunings."""

import pytest

from foreride.controller.settings import ControllerSettings
from foreride.controller.tuned_settings import TUNED_CONTROLLERS, settings_for, tuned_mapping
from foreride.files.reading import strict
from foreride.vehicle.load import load_vehicle


@pytest.mark.parametrize("name", ["quarter", "half", "full"])
def test_a_mapping_holds_the_tuned_controllers_alone_and_reads_back(name: str) -> None:
    car = load_vehicle(name)
    mapping, settings = tuned_mapping(car), settings_for(car)
    assert set(mapping) == set(TUNED_CONTROLLERS)
    read = strict.structure(ControllerSettings, mapping, "mapping")
    for controller in TUNED_CONTROLLERS:
        assert getattr(read, controller) == getattr(settings, controller)
