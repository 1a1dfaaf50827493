"""Tests of tunings carried over from one car to another."""

from dataclasses import replace
from typing import Any

import pytest

from foreride.controller.gain_scaling import critical_damping
from foreride.controller.settings import ControllerSettings
from foreride.controller.tuned_settings import (
    FOLDER,
    TUNED_CONTROLLERS,
    borrowed_tuning,
    settings_for,
    tuned_settings,
)
from foreride.vehicle.load import FullCar, HalfCar, QuarterCar, load_vehicle


def half(**changed: Any) -> HalfCar:
    car = load_vehicle("half")
    assert isinstance(car, HalfCar)
    return replace(car, **changed)


@pytest.mark.parametrize("name", ["quarter", "half", "full"])
def test_the_car_that_a_tuning_was_made_for_has_it_unchanged(name: str) -> None:
    car = load_vehicle(name)
    settings = settings_for(car)
    assert settings == tuned_settings(car.kind)
    assert [borrowed_tuning(car, settings, law) for law in TUNED_CONTROLLERS] == [None] * len(
        TUNED_CONTROLLERS
    )


def test_a_car_twice_as_heavy_and_as_stiff_has_twice_the_damping_at_the_same_ratio() -> None:
    car, shipped = load_vehicle("half"), tuned_settings("half_car")
    assert isinstance(car, HalfCar)
    twice = replace(
        car,
        body_mass_kg=2 * car.body_mass_kg,
        pitch_inertia_kg_m2=2 * car.pitch_inertia_kg_m2,
        unsprung_mass_kg=(2 * car.unsprung_mass_kg[0], 2 * car.unsprung_mass_kg[1]),
        spring_n_m=(2 * car.spring_n_m[0], 2 * car.spring_n_m[1]),
        tyre_n_m=(2 * car.tyre_n_m[0], 2 * car.tyre_n_m[1]),
        damping_max_ns_m=(9000.0, 9000.0),
    )
    settings = settings_for(twice)
    assert settings.skyhook.sky_ns_m == pytest.approx(2 * shipped.skyhook.sky_ns_m)
    assert settings.skyhook.ground_ns_m == pytest.approx(2 * shipped.skyhook.ground_ns_m)
    assert settings.skyhook.smoothing_m_s == shipped.skyhook.smoothing_m_s
    assert settings.fixed_best.rear_ns_m == pytest.approx(2 * shipped.fixed_best.rear_ns_m)
    assert settings.sh_add.crossover_hz == pytest.approx(shipped.sh_add.crossover_hz)
    assert settings.lqr_clipped == shipped.lqr_clipped
    ratio = shipped.fixed_best.front_ns_m / critical_damping(car.corners[0])
    assert settings.fixed_best.front_ns_m / critical_damping(twice.corners[0]) == pytest.approx(ratio)


def test_a_stiffer_front_spring_changes_the_front_damping_alone() -> None:
    car, shipped = load_vehicle("half"), tuned_settings("half_car")
    assert isinstance(car, HalfCar)
    stiff = half(spring_n_m=(4 * car.spring_n_m[0], car.spring_n_m[1]))
    settings = settings_for(stiff)
    assert settings.fixed_best.front_ns_m == pytest.approx(2 * shipped.fixed_best.front_ns_m)
    assert settings.fixed_best.rear_ns_m == shipped.fixed_best.rear_ns_m


def test_a_borrowed_tuning_is_said_unless_the_user_has_given_one() -> None:
    car = half(body_mass_kg=1200.0)
    settings = settings_for(car)
    assert borrowed_tuning(car, settings, "skyhook") == "half_car"
    assert borrowed_tuning(car, settings, "mpc_preview") is None
    own = replace(settings, skyhook=replace(settings.skyhook, sky_ns_m=1000.0))
    assert borrowed_tuning(car, own, "skyhook") is None


@pytest.mark.parametrize("name", ["compact_car", "suv", "van", "heavy_van"])
def test_shipped_cars_have_a_best_fixed_damping_of_their_own_and_scaled_laws(name: str) -> None:
    car = load_vehicle(name)
    settings = settings_for(car)
    assert (FOLDER / f"{name}.yaml").is_file()
    assert borrowed_tuning(car, settings, "fixed_best") is None
    assert borrowed_tuning(car, settings, "skyhook") == "full_car"
    assert settings.fixed_best != tuned_settings("full_car").fixed_best


def test_the_extremes_of_cars_stay_within_the_ranges_of_the_settings() -> None:
    quarter, full = load_vehicle("quarter"), load_vehicle("full")
    assert isinstance(quarter, QuarterCar)
    assert isinstance(full, FullCar)
    toy = replace(
        quarter, sprung_mass_kg=0.1, unsprung_mass_kg=0.01, spring_n_m=20.0, tyre_n_m=100.0,
        tyre_damping_ns_m=0.0, damping_min_ns_m=0.1, damping_passive_ns_m=1.0, damping_max_ns_m=4.0,
    )  # fmt: skip
    truck = replace(
        full, body_mass_kg=40_000.0, pitch_inertia_kg_m2=2e5, roll_inertia_kg_m2=4e4,
        unsprung_mass_kg=(700.0, 900.0), spring_n_m=(6e5, 8e5), tyre_n_m=(3e6, 3e6),
        damping_min_ns_m=(3e3, 3e3), damping_passive_ns_m=(4e4, 4e4), damping_max_ns_m=(2e5, 2e5),
    )  # fmt: skip
    for car in (toy, truck):
        assert isinstance(settings_for(car), ControllerSettings)
