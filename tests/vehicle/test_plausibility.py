"""Tests of the limits on parameters that lie in their ranges, but not together."""

import re
from copy import copy
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from foreride.files.errors import InputError
from foreride.files.reading import strict
from foreride.vehicle.linear_model import linear_twin, natural_frequencies_hz
from foreride.vehicle.load import Car, load_vehicle
from foreride.vehicle.plausibility import (
    MAX_BODY_FREQUENCY_HZ,
    MAX_EIGENVALUE_1_S,
    MIN_BODY_FREQUENCY_HZ,
    _frequencies_hz,
    _matrices,
    _quantities,
    doubts,
)

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


def test_limits_are_those_that_the_documentation_states() -> None:
    """Value, then what is possible and what is usual, of a quarter car with R = 0.31 m."""
    found = {(q.field, q.effect_unit): (q.of(q.value), q.possible, q.usual) for q in quantities_of("quarter")}
    load_n = 400.0 * 9.80665
    expected = {
        ("sprung_mass_kg", "times"): (400.0 / 42.0, (1.0, 1000.0), (3.0, 25.0)),
        ("sprung_mass_kg", "kg"): (400.0, (0.0, np.inf), (100.0, 1500.0)),
        ("tyre_n_m", "m"): ((load_n + 42.0 * 9.80665) / 195e3, (0.00155, 0.31), (0.0062, 0.0775)),
        ("spring_n_m", "m"): (load_n / 21e3, (0.001, 3.0), (0.02, 0.5)),
        ("damping_passive_ns_m", "times"): (
            1500.0 / (2.0 * np.sqrt(21e3 * 400.0)),
            (0.0, np.inf),
            (0.05, 1.0),
        ),
    }
    assert found.keys() == expected.keys()
    for key, numbers in expected.items():
        for ours, theirs in zip(found[key], numbers, strict=True):
            np.testing.assert_allclose(ours, theirs)
    assert (MIN_BODY_FREQUENCY_HZ, MAX_BODY_FREQUENCY_HZ, MAX_EIGENVALUE_1_S) == (0.05, 20.0, 500.0)


def quantities_of(name: str) -> list[Any]:
    return list(_quantities(load_vehicle(name)))


@pytest.mark.parametrize(
    ("name", "axles"), [("half", ["[0]", "[1]"]), ("full", ["[0]", "[0]", "[1]", "[1]"])]
)
def test_fields_are_named_by_axle_and_carry_their_own_load(name: str, axles: list[str]) -> None:
    car, listed = load_vehicle(name), quantities_of(name)
    assert [q.field for q in listed if "spring" in q.field] == [f"spring_n_m{axle}" for axle in axles]
    for corner, spring in zip(car.corners, (q for q in listed if "spring" in q.field), strict=True):
        assert spring.of(spring.value) == pytest.approx(corner.body_load_n / corner.spring_n_m)
    masses = [q for q in listed if q.field == "body_mass_kg" and q.effect_unit == "kg"]
    assert sum(q.of(q.value) for q in masses) == pytest.approx(car.generalised_mass[0])
    assert [q.effect for q in masses] == [f"puts {{}} on wheel {i}" for i in range(car.wheels)]


@pytest.mark.parametrize("name", SHIPPED)
def test_matrices_are_those_of_the_linear_twin(name: str) -> None:
    """Frequencies of the twin, and its poles at maximum damping."""
    car = load_vehicle(name)
    stiffness, damping, mass = _matrices(car)
    np.testing.assert_allclose(_frequencies_hz(stiffness, mass), natural_frequencies_hz(car), rtol=1e-9)
    size = len(mass)
    system = np.block(
        [[np.zeros((size, size)), np.eye(size)], [-stiffness / mass[:, None], -damping / mass[:, None]]]
    )
    twin = linear_twin(car, [corner.damping_max_ns_m for corner in car.corners])
    np.testing.assert_allclose(
        np.poly(np.linalg.eigvals(system)),
        np.poly(twin.poles()),
        rtol=1e-6,
        atol=1e-6 * abs(np.poly(twin.poles())[-1]),
    )


@pytest.mark.parametrize(
    ("place", "outside"), [(0.999, True), (1.0, False), (1.5, False), (2.0, False), (2.001, True)]
)
def test_a_limit_itself_is_allowed(place: float, outside: bool) -> None:
    one = replace(quantities_of("quarter")[0], value=place, of=lambda value: value)
    assert one.outside((1.0, 2.0)) == outside


@pytest.mark.parametrize(
    ("mode", "hz", "within"),
    [("body", 0.5, 1.02), ("body", 5.0, 0.99), ("wheels", 5.0, 1.02), ("wheels", 25.0, 0.99)],
)
def test_natural_frequencies_are_usual_between_their_limits(mode: str, hz: float, within: float) -> None:
    car = load_vehicle("quarter")
    for factor, doubted in ((within, False), (2.0 - within, True)):
        twin = _scaled(car, mode, factor * hz)
        assert any(line.startswith(f"{mode} with natural") for line in doubts(twin)) == doubted


def _scaled(car: Any, mode: str, frequency_hz: float) -> Any:
    """The car with both stiffnesses scaled so that this mode has the frequency, unchecked."""
    of = {"body": 0, "wheels": 1}[mode]
    scale = (frequency_hz / natural_frequencies_hz(car)[of]) ** 2
    twin = copy(car)
    vars(twin).pop("corners", None)
    for name in ("spring_n_m", "tyre_n_m"):
        object.__setattr__(twin, name, scale * getattr(car, name))
    return twin
