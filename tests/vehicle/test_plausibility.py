"""Tests of the limits on parameters that lie in their ranges, but not together."""

import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from foreride.files.errors import InputError
from foreride.files.reading import strict
from foreride.vehicle.load import Car, load_vehicle
from foreride.vehicle.plausibility import doubts

SHIPPED = sorted(path.stem for path in (Path(__file__).parents[2] / "vehicle" / "parameters").glob("*.yaml"))


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
        car = replace(load_vehicle("quarter"), **parameters)  # type: ignore[arg-type]
        assert car.wheels == 1
        assert any("usual are" in line for line in doubts(car))


WRONG_UNITS = [
    (
        {"spring_n_m": [30.5, 36.0]},
        r"spring_n_m\[0\] = 30.5 N/m lets the spring sink by .* m, must be 0.001 ... 3 m.*N/mm.*30500 N/m",
    ),
    ({"tyre_n_m": [255, 255]}, r"tyre_n_m\[0\] = 255 N/m lets the tyre sink by .* m.*N/mm.*255000 N/m"),
    (
        {"stop_gap_m": [85, 90]},
        r"stop_gap_m\[0\] must lie in 0.001 ... 0.5 m, got 85.0; in mm it would be 0.085 m",
    ),
    (
        {"body_mass_kg": 1.6},
        r"body_mass_kg = 1.6 kg loads wheel 0 with 0.01.* times.*; in t it would be 1600 kg",
    ),
    ({"track_m": 1640}, r"track_m must lie in 0.2 ... 4 m, got 1640.0; in mm it would be 1.64 m"),
    ({"wheel_radius_m": 37}, r"wheel_radius_m must .*; in mm it would be 0.037 m"),
    ({"stop_n_m2": [1e9, 1e9]}, r"stop_n_m2\[0\] must lie in 1 ... 100000000 N/m², got 1000000000.0"),
]


@pytest.mark.parametrize(("changes", "message"), WRONG_UNITS)
def test_a_value_in_another_unit_is_refused_with_its_meaning_and_the_likely_unit(
    changes: dict[str, Any], message: str
) -> None:
    mapping = strict.to_mapping(load_vehicle("full")) | changes
    with pytest.raises(InputError, match=message) as caught:
        strict.structure(Car, mapping, "suv.yaml")
    assert str(caught.value).startswith("suv.yaml: ")


@pytest.mark.parametrize("name", SHIPPED)
def test_the_shipped_cars_raise_no_doubt(name: str) -> None:
    assert doubts(load_vehicle(name)) == ()


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"damping_passive_ns_m": 100.0, "damping_min_ns_m": 50.0}, "is 0.01725 times critical damping"),
        ({"spring_n_m": 3000.0}, "lets the spring sink by 1.308 m, usual are 0.02 ... 0.5 m"),
        ({"spring_n_m": 4.2e5}, "body with natural frequencies of 2.9.* Hz|lets the spring sink by 0.0093"),
        ({"tyre_n_m": 9e5}, "wheels with natural frequencies of 23.6|lets the tyre sink by 0.0048"),
        ({"sprung_mass_kg": 90.0}, "puts 90 kg on wheel 0, usual are 100 ... 1500 kg"),
    ],
)
def test_what_no_passenger_car_has_is_said_and_driven(changes: dict[str, Any], message: str) -> None:
    car = replace(load_vehicle("quarter"), **changes)
    assert any(re.search(message, line) for line in doubts(car))


def test_a_stiff_bar_is_doubted_at_either_axle() -> None:
    """A car alike in front and behind, whose wheels hop too fast with a bar at one axle."""
    car = load_vehicle("full")
    alike = {
        name: (getattr(car, name)[0],) * 2
        for name in ("unsprung_mass_kg", "spring_n_m", "tyre_n_m", "damping_max_ns_m", "damping_passive_ns_m")
    }
    told = [
        doubts(replace(car, front_axle_m=1.3, rear_axle_m=1.3, anti_roll_n_m=bars, **alike))
        for bars in ((4e5, 0.0), (0.0, 4e5))
    ]
    assert any("natural frequencies" in line for line in told[0])
    assert told[0] == told[1]
