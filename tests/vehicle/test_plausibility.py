"""Tests of the limits on parameters that lie in their ranges, but not together."""

from dataclasses import replace
from typing import Any

import pytest

from foreride.files.errors import InputError
from foreride.vehicle.load import load_vehicle


@pytest.mark.parametrize(
    ("model", "changes", "field"),
    [
        ("quarter", {"unsprung_mass_kg": 5.0}, "damping_max_ns_m"),
        ("quarter", {"unsprung_mass_kg": 500.0}, "unsprung_mass_kg"),
        ("quarter", {"spring_n_m": 500.0}, "spring_n_m"),
        ("quarter", {"spring_n_m": 5e6}, "spring_n_m"),
        ("quarter", {"tyre_n_m": 1e4}, "tyre_n_m"),
        ("half", {"damping_max_ns_m": (4500.0, 4e5)}, "damping_max_ns_m"),
        ("half", {"pitch_inertia_kg_m2": 2e6}, "spring_n_m"),
        ("full", {"tyre_n_m": (2e7, 2e7)}, "tyre_n_m"),
        ("full", {"body_mass_kg": 50.0}, "unsprung_mass_kg"),
    ],
)
def test_parameters_that_do_not_fit_one_another_are_refused(
    model: str, changes: dict[str, Any], field: str
) -> None:
    with pytest.raises(InputError, match=field):
        replace(load_vehicle(model), **changes)


def test_a_model_car_and_a_truck_are_cars() -> None:
    small = {"sprung_mass_kg": 0.5, "unsprung_mass_kg": 0.08, "spring_n_m": 150.0, "tyre_n_m": 3000.0}
    small |= {"tyre_damping_ns_m": 1.0, "damping_min_ns_m": 1.0, "damping_passive_ns_m": 5.0}
    small |= {"damping_max_ns_m": 15.0, "stop_gap_m": 0.01, "wheel_radius_m": 0.05, "track_m": 0.25}
    large = {"sprung_mass_kg": 9000.0, "unsprung_mass_kg": 700.0, "spring_n_m": 6e5, "tyre_n_m": 2e6}
    large |= {"damping_max_ns_m": 1e5, "damping_passive_ns_m": 3e4, "wheel_radius_m": 0.52}
    for parameters in (small, large):
        assert replace(load_vehicle("quarter"), **parameters).wheels == 1  # type: ignore[arg-type]
