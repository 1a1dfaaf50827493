from dataclasses import replace

import numpy as np
import pytest

from foreride.road.tyre.wheel_profile import WheelProfile
from foreride.vehicle.dampers.actuator import FullyActive, SlowActive
from foreride.vehicle.dampers.damper import MrTanhDamper
from foreride.vehicle.energy_audit import energy_audit
from foreride.vehicle.load import Car, load_vehicle
from foreride.vehicle.plant.plant import Plant
from foreride.vehicle.state import VehicleState

QUARTER = load_vehicle("quarter")
FLAT = WheelProfile(0.0, 1.0, np.zeros(3))
ROUGH = WheelProfile(0.0, 0.2, 0.02 * np.random.default_rng(2).standard_normal(60))


def drive(car: Car, command: list[float], ticks: int, road: WheelProfile) -> VehicleState:
    plant = Plant(car)
    plant.reset([road], 0.0, 10.0)
    plant.step(command, ticks)
    return plant.signals


def audited(record: VehicleState) -> dict[str, np.ndarray]:
    names = "damper_force", "rattle_velocity", "damping", "actuator_force"
    return {name: getattr(record, name) for name in names}


def test_a_damper_in_its_range_produces_nothing() -> None:
    audit = energy_audit(QUARTER, **audited(drive(QUARTER, [9000.0], 800, ROUGH)))
    assert audit == {"damper_produced": 0.0, "damping_outside": 0.0}


def test_what_a_hysteresis_gives_back_is_told() -> None:
    car = replace(QUARTER, damper=MrTanhDamper())
    record = drive(car, [4500.0], 800, ROUGH)
    audit = energy_audit(car, **audited(record))
    spent = -np.sum(record.damper_force * record.rattle_velocity) / 1000
    assert 0.0 < audit["damper_produced"] < 0.02 * spent


def test_a_setting_outside_its_range_is_told() -> None:
    record = drive(QUARTER, [1500.0], 100, FLAT)
    narrow = replace(QUARTER, damping_min_ns_m=1600.0, damping_passive_ns_m=1600.0)
    assert energy_audit(narrow, **audited(record))["damping_outside"] == pytest.approx(0.101)


@pytest.mark.parametrize("actuator", [SlowActive(1000.0, 0.1), FullyActive(1000.0, 0.005)])
def test_lifting_the_body_takes_the_work_of_the_strut(actuator: SlowActive | FullyActive) -> None:
    """The work of the actuator until rest is stored in the spring or dissipated."""
    car = replace(QUARTER, actuator=actuator)
    record = drive(car, [1500.0, 5000.0], 4000, FLAT)
    assert record.actuator_force[0, -1] == pytest.approx(1000.0)
    assert record.rattle_m[0, -1] == pytest.approx(1000.0 / 21000.0, rel=1e-3)
    assert record.actuator_force[0, 100] == pytest.approx(1000.0 * -np.expm1(-0.1 / actuator.lag_s), rel=1e-6)
    audit = energy_audit(car, **audited(record))
    stored = 21000.0 * record.rattle_m[0, -1] ** 2 / 2
    tyre = np.sum(100.0 * record.wheel_v[0] ** 2) / 1000
    heat = -np.sum(record.damper_force * record.rattle_velocity) / 1000
    work = audit["actuator_energy"] - audit["actuator_recovered"]
    assert work == pytest.approx(stored + heat + tyre, rel=0.01)
    assert audit["actuator_power_peak"] > audit["actuator_power"] > 0.0
