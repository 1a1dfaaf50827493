"""Tests of documents with any value at any place: read and written back the same, or refused in one line."""

import copy
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from foreride.controller.settings import ControllerSettings
from foreride.files.errors import InputError
from foreride.files.reading import strict
from foreride.scenarios.definition.loading import load
from foreride.scenarios.definition.schema import Scenario
from foreride.vehicle.load import Car

SCENARIO = load("mixed_40", ["vehicle.model=full"])
DOCUMENTS: dict[str, tuple[Any, dict[str, Any]]] = {
    "scenario": (Scenario, SCENARIO.mapping),
    "car": (Car, SCENARIO.mapping["vehicle"]["parameters"]),
    "settings": (ControllerSettings, strict.to_mapping(ControllerSettings())),
}
SCALARS = (
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(st.characters(), max_size=20)
    | st.sampled_from([10**400, -(10**400), 2**63, 1e300, -1e-300, "\0", "\ud800", "²", "../x", "a\nb"])
)  # fmt: skip
VALUES = st.recursive(
    SCALARS,
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(SCALARS, inner, max_size=3),
    max_leaves=6,
)


def places(value: Any) -> list[tuple[Any, Any]]:
    """Container and key of every value within nested mappings and lists."""
    keys = list(value) if isinstance(value, dict) else range(len(value)) if isinstance(value, list) else ()
    return [(value, key) for key in keys] + [place for key in keys for place in places(value[key])]


@pytest.mark.parametrize("name", DOCUMENTS)
@settings(max_examples=150, derandomize=True)
@given(data=st.data())
def test_any_value_anywhere_is_read_or_refused(name: str, data: st.DataObject) -> None:
    cls, valid = DOCUMENTS[name]
    document = copy.deepcopy(strict.to_mapping(valid))
    holder, key = data.draw(st.sampled_from(places(document)).filter(bool))
    if isinstance(holder, dict) and data.draw(st.booleans()):
        holder[data.draw(SCALARS.filter(lambda value: value.__hash__ is not None))] = holder.pop(key)
    else:
        holder[key] = data.draw(VALUES)
    found, told = None, "file.yaml"
    try:
        found = strict.structure(cls, document, "file.yaml")
    except InputError as error:
        told = str(error)
    assert told.startswith("file.yaml")
    assert told.isprintable()
    assert len(told) < 500
    if found is not None:
        assert strict.structure(cls, strict.to_mapping(found), "file.yaml") == found
