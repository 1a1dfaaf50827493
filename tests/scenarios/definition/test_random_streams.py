"""Tests of the random streams: the seed's children in their order, others by name."""

import numpy as np

from foreride.scenarios.definition.random_streams import random_stream

NUMBERED = ("sensors", "boxes", "mounting", "image", "oracle", "faults", "map")


def test_numbered_streams_are_the_children_of_the_seed() -> None:
    children = np.random.SeedSequence(5).spawn(len(NUMBERED))
    for name, child in zip(NUMBERED, children, strict=True):
        assert random_stream(5, name).random(3).tolist() == np.random.default_rng(child).random(3).tolist()


def test_any_other_name_is_a_stream_of_its_own_that_shifts_none() -> None:
    names = [*NUMBERED, "lidar", "radar", "l"]
    first = [random_stream(5, name).random() for name in names]
    assert len(set(first)) == len(names)
    assert first == [random_stream(5, name).random() for name in names]
    assert random_stream(6, "lidar").random() != random_stream(5, "lidar").random()
