"""Tests of the sensor monitor."""

from dataclasses import replace

import numpy as np
import pytest

from foreride.controller.interface import ALL_SILENT
from foreride.controller.observer.sensor_monitor import SensorMonitor
from foreride.vehicle.plant.sensors import NO_NOISE, Measurement, SensorNoise

STUCK_READINGS = 4


def reading(k: int, wheels: int = 2, **changed: object) -> Measurement:
    """Reading number k of a car in motion; no two are equal, except in the roll rate without a roll gyro."""
    rng = np.random.default_rng(k)
    struts = rng.normal(size=wheels), rng.normal(size=wheels), 0.01 * rng.normal(size=wheels)
    sound = Measurement(0.005 * k, *struts, 0.1 * k, 10.0 + k, 0.2 * k if wheels > 2 else 0.0)
    return replace(sound, **changed)  # type: ignore[arg-type]


def test_sound_readings_pass_unchanged() -> None:
    watch = SensorMonitor(2, SensorNoise())
    for k in range(20):
        sound = reading(k)
        checked = watch.check(sound)
        assert checked.measurement is sound
        assert (checked.faults, any(checked.lost)) == ((), False)


@pytest.mark.parametrize(
    ("name", "value", "fault", "channel"),
    [
        ("body_acc", np.array([0.5, np.nan]), "body_acc_1 silent", 1),
        ("wheel_acc", np.array([np.inf, 0.5]), "wheel_acc_0 silent", 2),
        ("rattle_m", np.array([0.7, 0.01]), "rattle_m_0 out of range", 4),
        ("pitch_rate", float("nan"), "pitch_rate silent", 6),
        ("speed_m_s", 400.0, "speed_m_s out of range", 7),
    ],
)
def test_a_bad_reading_is_named_and_held_at_the_last_good_one_until_the_sensor_is_back(
    name: str, value: object, fault: str, channel: int
) -> None:
    watch = SensorMonitor(2, SensorNoise())
    good = reading(0)
    watch.check(good)
    checked = watch.check(reading(1, **{name: value}))
    assert checked.faults == (fault,)
    assert np.flatnonzero(checked.lost).tolist() == [channel]
    wheel = int(fault.split()[0][-1]) if fault.split()[0][-1].isdigit() else None
    held, before = getattr(checked.measurement, name), getattr(good, name)
    assert held == before if wheel is None else held[wheel] == before[wheel]
    assert watch.check(reading(2)).faults == ()


def test_a_sensor_is_stuck_after_some_equal_readings_and_back_with_the_first_other_one() -> None:
    watch = SensorMonitor(2, SensorNoise())
    faults = []
    for k in range(10):
        rattle = np.array([0.01, 0.001 * k]) if k < 8 else np.array([0.001 * k, 0.02])
        faults.append(watch.check(reading(k, rattle_m=rattle)).faults)
    assert faults[: STUCK_READINGS - 1] == [()] * (STUCK_READINGS - 1)
    assert faults[STUCK_READINGS - 1 : 8] == [("rattle_m_0 stuck",)] * (9 - STUCK_READINGS)
    assert faults[8:] == [(), ()]


@pytest.mark.parametrize("wheels", [1, 2, 4])
@pytest.mark.parametrize("value", [float("nan"), 0.3, 99.0])
def test_a_lost_roll_gyro_is_no_fault_of_what_control_needs_and_reads_zero(wheels: int, value: float) -> None:
    watch = SensorMonitor(wheels, SensorNoise())
    for k in range(10):
        checked = watch.check(reading(k, wheels, roll_rate=value))
        assert checked.faults == ()
    lost = wheels > 2 or value != 0.3
    assert checked.lost == (False,) * (3 * wheels + 2) + (lost,)
    assert checked.measurement.roll_rate == (0.0 if lost else value)
    assert watch.check(reading(10, wheels)).lost == (False,) * (3 * wheels + 3)


@pytest.mark.parametrize("wheels", [1, 2, 4])
def test_sensors_that_are_all_stuck_have_a_name_of_their_own(wheels: int) -> None:
    watch, still = SensorMonitor(wheels, SensorNoise()), reading(0, wheels)
    faults = [watch.check(still).faults for _ in range(STUCK_READINGS + 1)]
    assert faults == [()] * (STUCK_READINGS - 1) + [(ALL_SILENT,)] * 2
    assert watch.check(reading(1, wheels)).faults == ()


def test_sensors_without_noise_may_repeat_themselves() -> None:
    watch, still = SensorMonitor(2, NO_NOISE), reading(0)
    assert all(watch.check(still).faults == () for _ in range(10))


@pytest.mark.parametrize("wheels", [1, 2, 4])
def test_a_silent_bus_has_a_name_of_its_own(wheels: int) -> None:
    watch = SensorMonitor(wheels, SensorNoise())
    nothing = np.full(wheels, np.nan)
    checked = watch.check(Measurement(0.0, nothing, nothing, nothing, *[float("nan")] * 3))
    assert checked.faults == (ALL_SILENT,)
    assert np.isfinite(checked.measurement.rattle_m).all()


@pytest.mark.parametrize(
    ("name", "limit"),
    [("body_acc", 150.0), ("wheel_acc", 2000.0), ("rattle_m", 0.4), ("pitch_rate", 10.0),
     ("speed_m_s", 110.0), ("roll_rate", 10.0)],
)  # fmt: skip
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_reading_may_be_as_large_as_sensors_and_cars_allow(name: str, limit: float, sign: float) -> None:
    for factor, lost in ((1.0, False), (1.001, True)):
        value: object = sign * factor * limit
        if name in ("body_acc", "wheel_acc", "rattle_m"):
            value = np.array([0.1, sign * factor * limit, 0.2, 0.3])
        checked = SensorMonitor(4, SensorNoise()).check(reading(1, 4, **{name: value}))
        assert any(checked.lost) == lost
