"""Corner of a car by hand: loads, spring, settings, and the limits of its parameters."""

from dataclasses import replace

import numpy as np
import pytest

from foreride.files.errors import InputError
from foreride.vehicle.corner import Corner, require_damping_order
from foreride.vehicle.dampers.damper import MrTanhDamper, ValveDamper
from foreride.vehicle.load import FullCar, HalfCar, load_vehicle
from foreride.vehicle.spring_table import SpringTable

QUARTER, HALF, FULL = load_vehicle("quarter"), load_vehicle("half"), load_vehicle("full")
G = 9.80665


def test_axles_share_the_weight_by_the_lever_and_wheels_that_of_their_axle() -> None:
    """The front carries what the rear axle's distance is of the wheelbase."""
    for car in (HALF, FULL):
        ratio = car.rear_axle_m / (car.front_axle_m + car.rear_axle_m)
        wheels = car.wheels // 2
        shares = [ratio / wheels] * wheels + [(1.0 - ratio) / wheels] * wheels
        loads = [corner.body_load_n for corner in car.corners]
        np.testing.assert_allclose(loads, car.body_mass_kg * G * np.array(shares))


def test_a_tyre_carries_body_and_wheel_and_sinks_by_its_stiffness() -> None:
    (corner,) = QUARTER.corners
    force = (QUARTER.sprung_mass_kg + QUARTER.unsprung_mass_kg) * G
    assert corner.static_tyre_n == pytest.approx(force)
    assert corner.static_tyre_deflection_m == pytest.approx(force / QUARTER.tyre_n_m)


@pytest.mark.parametrize("car", [HALF, FULL], ids=["half", "full"])
def test_every_value_of_an_axle_reaches_its_wheels(car: object) -> None:
    """Front and rear differ in all fields."""
    names = (
        "unsprung_mass_kg", "spring_n_m", "tyre_n_m", "tyre_damping_ns_m", "damping_min_ns_m",
        "damping_max_ns_m", "damping_passive_ns_m", "stop_gap_m", "rebound_gap_m", "stop_n_m2", "spring_n_m3",
    )  # fmt: skip
    values = {
        "unsprung_mass_kg": (40.0, 45.0), "spring_n_m": (20e3, 23e3), "tyre_n_m": (190e3, 200e3),
        "tyre_damping_ns_m": (90.0, 110.0), "damping_min_ns_m": (250.0, 350.0),
        "damping_max_ns_m": (4000.0, 5000.0), "damping_passive_ns_m": (1400.0, 1700.0),
        "stop_gap_m": (0.07, 0.08), "rebound_gap_m": (0.06, 0.09), "stop_n_m2": (9e6, 1.1e7),
        "spring_n_m3": (1e5, 2e5),
    }  # fmt: skip
    dampers = MrTanhDamper(), MrTanhDamper(slope_s_m=80.0)
    changed = replace(car, **values, damper=dampers, damper_lag_s=0.01)  # type: ignore[type-var]
    half = changed.wheels // 2
    for i, corner in enumerate(changed.corners):
        axle = i // half
        assert {name: getattr(corner, name) for name in names} == {
            name: pair[axle] for name, pair in values.items()
        }
        assert (corner.damper, corner.damper_lag_s) == (dampers[axle], 0.01)
    same = replace(changed, rebound_gap_m=None)
    assert [corner.rebound_gap_m for corner in same.corners] == [c.stop_gap_m for c in changed.corners]


def test_a_spring_pushes_in_proportion_and_with_the_cube_of_its_travel() -> None:
    corner = replace(QUARTER, spring_n_m3=1e6).corners[0]
    for travel in (-0.05, 0.03):
        expected = -QUARTER.spring_n_m * travel - 1e6 * travel**3
        assert corner.spring_force(travel, np) == pytest.approx(expected)


def test_a_setting_is_normalised_by_the_dampers_range() -> None:
    (corner,) = QUARTER.corners
    low, high = corner.damping_min_ns_m, corner.damping_max_ns_m
    settings = [low, 0.25 * high + 0.75 * low, high]
    assert [corner.normalised_setting(setting) for setting in settings] == pytest.approx([0.0, 0.25, 1.0])


def test_the_passive_damping_may_be_an_end_of_the_range() -> None:
    require_damping_order(300.0, 300.0, 4500.0)
    require_damping_order(300.0, 4500.0, 4500.0)
    for passive in (299.0, 4501.0):
        with pytest.raises(InputError, match=r"damping_passive_ns_m\[1\] must lie between damping_min_ns_m"):
            require_damping_order(300.0, passive, 4500.0, "[1]")


def test_seats_are_between_the_axles_and_there_is_one() -> None:
    edges = (HALF.front_axle_m, -HALF.rear_axle_m)
    assert replace(HALF, seat_x_m=edges).seat_x_m == edges
    for number, seats in ((0, (HALF.front_axle_m + 0.01, 0.0)), (1, (0.0, -HALF.rear_axle_m - 0.01))):
        with pytest.raises(InputError, match=rf"seat_x_m\[{number}\] must lie between the axles"):
            replace(HALF, seat_x_m=seats)
    with pytest.raises(InputError, match="seat_x_m must name at least one seat"):
        replace(HALF, seat_x_m=())


@pytest.mark.parametrize("axle", [0, 1])
def test_a_wrong_axle_is_named(axle: int) -> None:
    passive = list(HALF.damping_passive_ns_m)
    passive[axle] = 9e4
    with pytest.raises(InputError, match=rf"damping_passive_ns_m\[{axle}\] must lie"):
        replace(HALF, damping_passive_ns_m=tuple(passive))
    with pytest.raises(InputError, match="damper must be of one kind on both axles, got mr_tanh and valve"):
        replace(HALF, damper=(MrTanhDamper(), ValveDamper()))


def test_corners_are_compared_by_their_values() -> None:
    assert isinstance(QUARTER.corners[0], Corner)
    assert replace(QUARTER).corners == QUARTER.corners
    assert replace(QUARTER, tyre_n_m=200e3).corners != QUARTER.corners


@pytest.mark.parametrize("car", [HALF, FULL], ids=["half", "full"])
def test_each_axle_has_a_spring_table_of_its_own(car: HalfCar | FullCar) -> None:
    half = car.wheels // 2
    loads = [corner.body_load_n for corner in car.corners][::half]
    tables = tuple(SpringTable((0.0, 2.0 * load / 21e3), (0.0, 2.0 * load)) for load in loads)
    changed = replace(car, spring_n_m=(21e3, 21e3), spring_table=tables)
    assert [corner.spring_table for corner in changed.corners] == [
        tables[i // half] for i in range(car.wheels)
    ]
