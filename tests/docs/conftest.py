"""Fixture: what a page registers is forgotten after it."""

from collections.abc import Iterator

import pytest

from foreride.comfort.registry import METRICS
from foreride.controller.registry import CONTROLLERS
from foreride.road.features.feature import FEATURES
from foreride.scenarios.perceptions.registry import PERCEPTIONS
from foreride.vehicle.dampers.damper import DAMPERS


@pytest.fixture(autouse=True)
def _registries_restored() -> Iterator[None]:
    registries = (CONTROLLERS, DAMPERS, FEATURES, METRICS, PERCEPTIONS)
    before = [set(registry.names()) for registry in registries]
    yield
    for registry, names in zip(registries, before, strict=True):
        for name in set(registry.names()) - names:
            registry.unregister(name)
