"""Closed-loop test of the memory: a second drive on the same road starts with the first one's estimates."""

import hashlib
from dataclasses import replace

from foreride.preview.prior_drives.memory_file import write
from foreride.road.features.feature import HalfSineBump
from foreride.road.road import Road
from foreride.scenarios.cases import Case
from foreride.scenarios.definition.loading import load
from foreride.scenarios.perception_benchmark.judge import encounters
from foreride.scenarios.simulation.simulate import simulate


def test_the_second_drive_knows_the_bump_from_the_start_and_places_it_as_well(tmp_path):
    base = replace(load("bump_8x40_30"), road=Road(length_m=62.0, features=(HalfSineBump(50.0, 0.08, 0.4),)))
    first = simulate(Case(base, "passive", "boxes", 3))
    assert first.memory is not None
    (place,) = first.memory.objects
    assert place.kind == "bump"
    assert abs(place.x_m - 50.0) < 0.5  # without the odometer's drift

    path = tmp_path / "memory.yaml"
    write(path, first.memory)
    second = simulate(Case(replace(base, memory=str(path)), "passive", "boxes", 3))
    assert first.files_sha256["memory_sha256"] is None
    assert second.files_sha256["memory_sha256"] == hashlib.sha256(path.read_bytes()).hexdigest()
    (before,), (after,) = encounters(first), encounters(second)
    assert after.first_confirmed_m is not None
    assert before.first_confirmed_m is not None
    assert after.first_confirmed_m > before.first_confirmed_m + 10.0
    assert after.used is not None
    assert abs(after.used.error_m) < 0.15
