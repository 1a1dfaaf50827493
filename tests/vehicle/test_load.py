import json
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import pytest

from foreride.files.errors import InputError
from foreride.files.reading import strict
from foreride.vehicle.corner import CORNER_FIELDS
from foreride.vehicle.linear_model import natural_frequencies_hz
from foreride.vehicle.load import GRAVITY_M_S2, FullCar, HalfCar, QuarterCar, load_vehicle

QUARTER, HALF = load_vehicle("quarter_car"), load_vehicle("half_car")
FULL = load_vehicle("full_car")
PAIRS = {*CORNER_FIELDS, "rebound_gap_m", "anti_roll_n_m"}
UNCHECKED = {"seat_x_m", "seat_y_m", "damper", "actuator", "spring_table"}
CHECKED: list[tuple[Any, str]] = [
    (car, f.name)
    for car, kind in ((QUARTER, QuarterCar), (HALF, HalfCar), (FULL, FullCar))
    for f in fields(kind)
    if f.name not in UNCHECKED
]


def test_static_load_is_the_weight_and_balances_the_pitching_moment() -> None:
    weight = sum(corner.body_load_n for corner in HALF.corners)
    moment = sum(corner.body_load_n * corner.x_m for corner in HALF.corners)
    assert weight == pytest.approx(HALF.body_mass_kg * GRAVITY_M_S2)
    assert moment == pytest.approx(0.0, abs=1e-9)
    assert QUARTER.corners[0].static_tyre_n == pytest.approx(442 * GRAVITY_M_S2)


def test_static_deflections_of_the_quarter_car() -> None:
    (corner,) = QUARTER.corners
    assert corner.static_rattle_m == pytest.approx(400 * 9.80665 / 21000)
    assert corner.static_tyre_deflection_m == pytest.approx(442 * 9.80665 / 195000)


def test_short_names_and_files_load_the_same_car(tmp_path: Path) -> None:
    path = tmp_path / "mine.yaml"
    path.write_text(json.dumps(strict.to_mapping(HALF)))
    assert load_vehicle(path) == load_vehicle("half") == HALF


def test_unknown_name_lists_the_shipped_ones() -> None:
    with pytest.raises(
        InputError, match=r"one of compact_car, full_car, half_car, .* or a \.yaml file, got 'tractor'"
    ):
        load_vehicle("tractor")


@pytest.mark.parametrize(("car", "name"), CHECKED)
@pytest.mark.parametrize("bad", [-1.0, float("nan"), float("inf")])
def test_every_parameter_is_checked(car: Any, name: str, bad: float) -> None:
    value = (1.0, bad) if isinstance(car.spring_n_m, tuple) and name in PAIRS else bad
    with pytest.raises(InputError, match=name):
        replace(car, **{name: value})


def test_passive_damping_lies_inside_the_range() -> None:
    with pytest.raises(InputError, match=r"damping_passive_ns_m must lie between .*300.*4500.* got 200"):
        replace(QUARTER, damping_passive_ns_m=200.0)
    with pytest.raises(InputError, match=r"damping_passive_ns_m\[1\] must lie"):
        replace(HALF, damping_passive_ns_m=(1500.0, 9000.0))


def test_seats_lie_between_the_axles() -> None:
    with pytest.raises(InputError, match=r"seat_x_m\[1\] must lie between the axles, got -1.5"):
        replace(HALF, seat_x_m=(0.0, -1.5))
    with pytest.raises(InputError, match="seat_x_m must name at least one seat"):
        replace(HALF, seat_x_m=())


def test_errors_of_a_file_name_it(tmp_path: Path) -> None:
    path = tmp_path / "car.yaml"
    path.write_text(
        "kind: quarter_car\nsprung_mass_kg: -1\nunsprung_mass_kg: 40\nspring_n_m: 1e4\ntyre_n_m: 2e5\n"
    )
    with pytest.raises(InputError, match=r"car\.yaml: sprung_mass_kg must lie in"):
        load_vehicle(path)


@pytest.mark.parametrize("name", ["compact_car", "suv", "van", "heavy_van"])
def test_shipped_cars_ride_like_cars(name: str) -> None:
    """Body modes over 1 Hz, wheel hop 10-15 Hz (Wong, Theory of Ground Vehicles, ch. 7)."""
    frequencies = natural_frequencies_hz(load_vehicle(name))
    assert (frequencies[:2] > 1.0).all()
    assert (frequencies[:2] < 1.7).all()
    assert 1.7 < frequencies[2] < 2.5
    assert (frequencies[3:] > 10.0).all()
    assert (frequencies[3:] < 15.0).all()


def test_the_laden_van_is_the_van_and_its_load() -> None:
    """Weight and moment are the sum of van and load; stops are nearer by the static compression."""
    van, laden = load_vehicle("van"), load_vehicle("heavy_van")
    more = [b.body_load_n - a.body_load_n for a, b in zip(van.corners, laden.corners, strict=True)]
    assert 2 * (more[0] + more[2]) == pytest.approx(600 * GRAVITY_M_S2)
    assert more[2] * 4 / (600 * GRAVITY_M_S2) == pytest.approx(2 * (1.151 + 0.5) / 2.472, rel=0.01)
    for a, b in zip(van.corners, laden.corners, strict=True):
        settled = b.static_rattle_m - a.static_rattle_m
        assert b.stop_gap_m == pytest.approx(a.stop_gap_m - settled, abs=2e-3)
        assert b.rebound_gap_m == pytest.approx(a.rebound_gap_m + settled, abs=2e-3)
