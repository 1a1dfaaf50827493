"""Tests of fault injection: time, place and kind."""

import numpy as np
import pytest

from foreride.files.errors import InputError
from foreride.preview.road_preview import flat_preview
from foreride.scenarios.definition.faults import LateAnswers, PreviewFault, SensorFault
from foreride.scenarios.simulation.fault_injection import Faults
from foreride.vehicle.plant.sensors import Measurement


def reading(time_s: float) -> Measurement:
    wheels = (np.full(2, share * time_s) for share in (1, 2, 3))
    return Measurement(time_s, *wheels, 4 * time_s, 10 + time_s, 5 * time_s)


def faults(*all_of_them: object, seed: int = 0) -> Faults:
    return Faults(all_of_them, np.random.default_rng(seed))  # type: ignore[arg-type]


def test_a_stuck_sensor_repeats_its_last_reading_and_the_others_go_on() -> None:
    drive = faults(SensorFault("rattle_m", "stuck", start_s=1.0, duration_s=1.0, wheel=1))
    seen = [drive.reading(reading(t)).rattle_m for t in (0.5, 1.0, 1.5, 2.0)]
    np.testing.assert_allclose(seen, [[1.5, 1.5], [3.0, 1.5], [4.5, 1.5], [6.0, 6.0]])


def test_a_silent_sensor_gives_no_number_and_a_silent_bus_none_at_all() -> None:
    one = faults(SensorFault("body_acc", "silent", 0.0, 1.0)).reading(reading(0.5))
    assert np.isnan(one.body_acc).tolist() == [True, False]
    assert np.isfinite(one.wheel_acc).all()
    bus = faults(SensorFault("all", "silent", 0.0, 1.0)).reading(reading(0.5))
    assert np.isnan([*bus.body_acc, *bus.wheel_acc, *bus.rattle_m]).all()
    assert np.isnan([bus.pitch_rate, bus.speed_m_s, bus.roll_rate]).all()


def test_a_frozen_preview_is_the_last_one_and_an_absurd_one_claims_cliffs() -> None:
    drive = faults(PreviewFault("frozen", 1.0, 1.0), PreviewFault("absurd", 3.0, 1.0))
    sent = {t: flat_preview(2, t) for t in (0.9, 1.0, 1.9, 2.0, 3.5)}
    got = {t: drive.preview(preview, t) for t, preview in sent.items()}
    assert got[1.0] is got[1.9] is sent[0.9]
    assert got[2.0] is sent[2.0]
    assert got[3.5].height_m.min() > 1.0  # type: ignore[union-attr]
    assert drive.preview(None, 3.5) is None


def test_answers_are_late_as_often_as_told_and_the_same_seed_repeats_it() -> None:
    rule = LateAnswers(1.0, 5.0, probability=0.3)
    drives = [faults(rule, seed=3), faults(rule, seed=3)]
    first, again = ([drive.late(1.0 + 0.001 * k) for k in range(3000)] for drive in drives)
    assert first == again
    assert np.mean(first) == pytest.approx(0.3, abs=0.04)
    assert not drives[0].late(0.9)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: SensorFault("all", "stuck", -1.0, 1.0), "start_s must lie in"),
        (lambda: PreviewFault("frozen", 0.0, 0.0), "duration_s must lie in 0.001"),
        (lambda: LateAnswers(0.0, 1.0, 1.5), "probability must lie in"),
        (lambda: SensorFault("all", "stuck", 0.0, 1.0, wheel=4), "wheel must lie in"),
    ],
)
def test_faults_out_of_range_are_refused(make: object, message: str) -> None:
    with pytest.raises(InputError, match=message):
        make()  # type: ignore[operator]
