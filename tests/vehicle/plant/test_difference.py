"""A plant that differs: only what is given changes, valves take their time, readings arrive as told."""

from dataclasses import replace

import numpy as np
import pytest

from foreride.files.errors import InputError
from foreride.vehicle.dampers.damper import MrTanhDamper, ScaledDamper
from foreride.vehicle.load import load_vehicle
from foreride.vehicle.plant.difference import DeliveredReadings, PlantDifference, Valves
from foreride.vehicle.plant.plant import Plant
from foreride.vehicle.plant.sensors import Measurement

HALF = load_vehicle("half")
STEP_S = 0.001


@pytest.mark.parametrize("name", ["quarter", "half", "full"])
def test_without_a_difference_the_car_is_the_same_object(name: str) -> None:
    car = load_vehicle(name)
    assert PlantDifference().applied(car) is car


@pytest.mark.parametrize("name", ["quarter", "half", "full"])
def test_ratios_scale_masses_with_their_inertias_springs_and_tyres(name: str) -> None:
    known = load_vehicle(name)
    true = PlantDifference(
        sprung_mass_ratio=1.2, unsprung_mass_ratio=1.1, spring_ratio=0.9, tyre_ratio=0.8
    ).applied(known)
    np.testing.assert_allclose(true.generalised_mass, 1.2 * np.array(known.generalised_mass))
    np.testing.assert_allclose(np.array(true.anti_roll_n_m), 0.9 * np.array(known.anti_roll_n_m))
    for ours, theirs in zip(true.corners, known.corners, strict=True):
        assert ours.unsprung_mass_kg == pytest.approx(1.1 * theirs.unsprung_mass_kg)
        assert ours.spring_n_m == pytest.approx(0.9 * theirs.spring_n_m)
        assert ours.tyre_n_m == pytest.approx(0.8 * theirs.tyre_n_m)
        assert ours.damper == theirs.damper


def test_any_damper_is_scaled_by_direction_and_keeps_its_own_states() -> None:
    known = replace(HALF, damper=MrTanhDamper())
    damper = PlantDifference(rebound_force_ratio=1.5, compression_force_ratio=0.5).applied(known).damper
    assert damper == ScaledDamper(1.5, 0.5, base=MrTanhDamper())
    for rate, ratio in ((0.3, 1.5), (-0.3, 0.5)):
        arguments = 2000.0, 0.4, 0.01, rate, [], np
        assert damper.force(*arguments) == pytest.approx(ratio * MrTanhDamper().force(*arguments))


def test_a_car_that_cannot_be_is_refused() -> None:
    with pytest.raises(InputError, match="unsprung_mass_kg"):
        PlantDifference(sprung_mass_ratio=0.2, unsprung_mass_ratio=5.0).applied(HALF)
    with pytest.raises(InputError, match="spring_ratio"):
        PlantDifference(spring_ratio=0.0)


def test_a_valve_crosses_its_range_in_the_full_stroke_and_lags_by_its_play() -> None:
    valves, span = Valves(HALF, 0.08, 0.1), 4200.0
    passive = 1500.0
    assert not valves.ideal
    settings = [valves.advance(np.full(2, 4500.0), STEP_S)[0] for _ in range(100)]
    assert settings[0] == pytest.approx(passive + span * STEP_S / 0.08)
    assert settings[-1] == pytest.approx(4500.0 - 0.05 * span)
    held = valves.advance(np.full(2, 4500.0 - 0.09 * span), STEP_S)
    np.testing.assert_allclose(held, settings[-1])
    assert Valves(HALF, 0.0, 0.0).ideal


def test_forces_of_actuators_pass_the_valves_unchanged() -> None:
    command = np.array([1500.0, 1500.0, 700.0, -700.0])
    np.testing.assert_array_equal(Valves(HALF, 0.08, 0.0).advance(command, STEP_S)[2:], command[2:])


class Counting:
    """Sensors whose every channel is the number of the reading."""

    def __init__(self) -> None:
        self.count = -1.0

    def measure(self, state: object) -> Measurement:
        self.count += 1.0
        return Measurement.of_channels(state.time_s, np.full(9, self.count))


def readings(difference: PlantDifference, count: int) -> list[Measurement]:
    plant, delivered = Plant(HALF), DeliveredReadings(Counting(), difference, HALF.wheels)
    plant.reset([FlatRoad()] * 2, 0.0, 10.0)
    collected = []
    for _ in range(count):
        collected.append(delivered.measure(plant.state))
        plant.step(np.full(2, 1500.0), 5)
    return collected


class FlatRoad:
    def height(self, x: object) -> object:
        return 0.0 * x

    def slope(self, x: object) -> object:
        return 0.0 * x


def test_bias_delay_and_rate_act_on_the_readings() -> None:
    biased = readings(PlantDifference(body_acc_bias_m_s2=0.3, rattle_bias_m=-0.01), 2)[1]
    np.testing.assert_allclose(biased.body_acc, 1.3)
    np.testing.assert_allclose(biased.rattle_m, 0.99)
    np.testing.assert_allclose(biased.wheel_acc, 1.0)
    late = readings(PlantDifference(sensor_delay_readings=2), 5)
    assert [reading.speed_m_s for reading in late] == [0.0, 0.0, 0.0, 1.0, 2.0]
    slow = readings(PlantDifference(sensor_rate_hz=100), 5)
    assert [reading.speed_m_s for reading in slow] == [0.0, 0.0, 2.0, 2.0, 4.0]
    assert slow[3].time_s == pytest.approx(0.015)
