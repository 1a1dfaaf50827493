"""Tests of spring tables, dampers of each axle, and passive force–velocity curves."""

from dataclasses import replace
from pathlib import Path

import casadi
import numpy as np
import pytest

from foreride.controller.registry import build
from foreride.files.errors import InputError
from foreride.vehicle import equations
from foreride.vehicle.corner import GRAVITY_M_S2
from foreride.vehicle.dampers.damper import MrTanhDamper, ValveDamper
from foreride.vehicle.linear_model import linear_twin
from foreride.vehicle.load import control_model, load_vehicle
from foreride.vehicle.spring_table import SpringTable

LOAD_N = 400 * GRAVITY_M_S2
TABLE = SpringTable((0.0, 0.1, 0.2, 0.25, 0.35), (0.0, 1500.0, 3600.0, 4900.0, 9000.0))
QUARTER = replace(load_vehicle("quarter"), spring_n_m=26000.0, spring_table=TABLE)
CURVE = ValveDamper((0.0,), (0.05, 0.3, 1.0), ((300.0, 900.0, 2000.0),), ((150.0, 500.0, 1100.0),))


def test_the_force_is_that_of_the_table_less_the_static_load() -> None:
    (corner,) = QUARTER.corners
    static_m = np.interp(LOAD_N, TABLE.force_n, TABLE.compression_m)
    travel = np.linspace(-0.11, 0.2, 63)
    expected = np.interp(static_m - travel, TABLE.compression_m, TABLE.force_n) - LOAD_N
    np.testing.assert_allclose(corner.spring_force(travel, np), expected, atol=1e-9)
    x = casadi.MX.sym("x")
    same = casadi.Function("f", [x], [corner.spring_force(x, casadi)])(travel)
    np.testing.assert_allclose(np.array(same).ravel(), expected, atol=1e-9)
    assert corner.spring_force(0.0, equations.FLOATS) == 0.0


@pytest.mark.parametrize(
    ("compression_m", "force_n", "told"),
    [
        ((0.0,), (0.0,), "at least 2 ascending"),
        ((0.0, 0.1, 0.1), (0.0, 1.0, 2.0), "ascending"),
        ((0.0, 0.1), (0.0, 1.0, 2.0), "force_n must hold 2 values"),
        ((0.0, 0.1, 0.2), (0.0, 2000.0, 3000.0), "never less steeply"),
        ((0.0, 0.1), (10.0, 10.0), "force_n must rise"),
    ],
)
def test_a_table_that_is_none_is_refused(
    compression_m: tuple[float, ...], force_n: tuple[float, ...], told: str
) -> None:
    with pytest.raises(InputError, match=told):
        SpringTable(compression_m, force_n)


def test_a_table_must_fit_its_car() -> None:
    with pytest.raises(InputError, match=r"spring_n_m must be 26000 N/m, within 5 %"):
        replace(QUARTER, spring_n_m=20000.0)
    with pytest.raises(InputError, match="spring_n_m3 must be 0"):
        replace(QUARTER, spring_n_m3=1e6)
    with pytest.raises(InputError, match="from below to above the 3923 N"):
        replace(QUARTER, spring_table=SpringTable((0.0, 0.1), (0.0, 3000.0)))
    half = load_vehicle("half")
    with pytest.raises(InputError, match=r"spring_n_m\[0\] must be"):
        replace(half, spring_table=(TABLE, TABLE))


def test_the_linear_twin_has_the_slope_at_standstill() -> None:
    linear = replace(QUARTER, spring_table=None)
    np.testing.assert_allclose(linear_twin(QUARTER).A, linear_twin(linear).A)


def test_each_axle_can_have_its_own_map() -> None:
    soft = ValveDamper()
    stiff = replace(soft, rebound_n=tuple(tuple(2 * force for force in row) for row in soft.rebound_n))
    car = replace(load_vehicle("full"), damper=(soft, stiff))
    assert [corner.damper for corner in car.corners] == [soft] * 2 + [stiff] * 2
    assert [corner.damper.kind for corner in control_model(car).corners] == ["valve"] * 4
    with pytest.raises(InputError, match="damper must be of one kind on both axles, got valve and mr_tanh"):
        replace(car, damper=(ValveDamper(), MrTanhDamper()))


def test_maps_per_axle_and_a_spring_table_are_read_from_a_file(tmp_path: Path) -> None:
    path = tmp_path / "car.yaml"
    path.write_text("""
kind: half_car
body_mass_kg: 800
pitch_inertia_kg_m2: 1100
front_axle_m: 1.35
rear_axle_m: 1.35
unsprung_mass_kg: [42, 42]
spring_n_m: [26000, 26000]
spring_table:
  - {compression_m: [0, 0.1, 0.2, 0.25, 0.35], force_n: [0, 1500, 3600, 4900, 9000]}
  - {compression_m: [0, 0.1, 0.2, 0.25, 0.35], force_n: [0, 1500, 3600, 4900, 9000]}
tyre_n_m: [195000, 195000]
damper:
  - {kind: valve, currents_a: [0.3, 1.6], speeds_m_s: [0.1, 1.0], rebound_n: [[100, 600], [900, 2500]],
     compression_n: [[60, 400], [500, 1500]]}
  - {kind: valve, currents_a: [0.3, 1.6], speeds_m_s: [0.1, 1.0], rebound_n: [[100, 600], [700, 2000]],
     compression_n: [[60, 400], [400, 1200]]}
""")
    car = load_vehicle(path)
    assert car.corners[0].spring_table == TABLE
    front, rear = (corner.damper for corner in car.corners)
    assert isinstance(front, ValveDamper)
    assert isinstance(rear, ValveDamper)
    assert (front.rebound_n[1][1], rear.rebound_n[1][1]) == (2500.0, 2000.0)


@pytest.mark.parametrize("rate", [-0.7, -0.02, 0.0, 0.3, 1.5])
def test_a_single_curve_gives_its_force_at_any_setting(rate: float) -> None:
    forces = {CURVE.force(0.0, setting, 0.0, rate, [], equations.FLOATS) for setting in (0.0, 0.4, 1.0)}
    points = [0.0, *(CURVE.rebound_n, CURVE.compression_n)[rate < 0.0][0]]
    last_slope = (points[-1] - points[-2]) / 0.7
    expected = np.interp(abs(rate), [0.0, *CURVE.speeds_m_s], points) + max(abs(rate) - 1.0, 0.0) * last_slope
    (force,) = forces
    assert force == pytest.approx(-np.sign(rate) * expected)


def test_controllers_can_be_built_for_a_car_with_passive_dampers() -> None:
    car = replace(load_vehicle("quarter"), damper=CURVE)
    assert build("passive", car).step is not None


def test_the_static_compression_is_that_at_which_the_table_carries_the_body() -> None:
    (corner,) = QUARTER.corners
    static_m = float(np.interp(LOAD_N, TABLE.force_n, TABLE.compression_m))
    assert corner.static_rattle_m == pytest.approx(static_m)
    assert corner.spring_force(static_m, np) == pytest.approx(-LOAD_N)
    (plain,) = load_vehicle("quarter").corners
    assert plain.static_rattle_m == pytest.approx(plain.body_load_n / plain.spring_n_m)
