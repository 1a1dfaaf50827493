"""Tests of failing exposures: left out, counted and reported, and the drive continues."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import foreride.scenarios.perceptions.camera as eyes
from foreride.detector.detections import Detections
from foreride.files.errors import InputError
from foreride.scenarios.cases import Case
from foreride.scenarios.definition.clock import TICKS_PER_SECOND
from foreride.scenarios.definition.loading import load
from foreride.scenarios.perceptions.detector_perception import BoxSource
from foreride.scenarios.perceptions.interface import Drive, Exposure
from foreride.scenarios.simulation.simulate import Run, simulate
from foreride.vehicle.state import VehicleState

SHORT = ["vehicle.model=quarter", "road.length_m=22", "road.features.0.start_m=10"]


def explode() -> None:
    raise RuntimeError("no frame")


def leave() -> None:
    raise SystemExit(3)


def blind() -> None:
    Detections(np.full((1, 4), np.nan), np.ones(1), np.zeros(1))


def interrupt() -> None:
    raise KeyboardInterrupt


def spoil(monkeypatch: pytest.MonkeyPatch, fail: Callable[[], None], first: int) -> None:
    """Make every box source fail from its exposure number `first` on, for four exposures."""
    true_eye = eyes.true_box_source

    def spoilt(*given: object) -> BoxSource:
        inner, asked = true_eye(*given), iter(range(10**6))  # type: ignore[arg-type]

        def look(tick: int, state: VehicleState, first_row: int) -> Exposure:
            if first <= next(asked) < first + 4:
                fail()
            return inner(tick, state, first_row)

        return look

    monkeypatch.setattr(eyes, "true_box_source", spoilt)


def drive() -> Run:
    return simulate(Case(load("bump_8x40_30", SHORT), "mpc_preview", "boxes", 0))


@pytest.mark.parametrize(
    ("fail", "kind"), [(explode, "RuntimeError"), (leave, "SystemExit"), (blind, "InputError")]
)
def test_failed_looks_are_left_out_counted_and_told_once(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], fail: Callable[[], None], kind: str
) -> None:
    whole = drive()
    spoil(monkeypatch, fail, 5)
    run = drive()
    failed = [event["reason"] for event in run.events if event["event"] == "look failed"]
    assert failed == [failed[0]] * 4
    assert failed[0].startswith(f"{kind} at {Path(__file__).name}:")
    assert run.perception_stats["failed_looks"] == 4
    assert run.perception_stats["frames"] == whole.perception_stats["frames"] - 4
    assert "failed_looks" not in whole.perception_stats
    assert np.isfinite(run.metrics["objective"])
    (said,) = capsys.readouterr().err.splitlines()
    assert said.startswith(f"foreride: perception: a look failed and is left out: {kind}")


def test_bad_input_at_the_first_look_ends_the_run(monkeypatch: pytest.MonkeyPatch) -> None:
    spoil(monkeypatch, blind, 0)
    with pytest.raises(InputError, match="boxes must be finite"):
        drive()


def test_ctrl_c_is_no_failed_look(monkeypatch: pytest.MonkeyPatch) -> None:
    spoil(monkeypatch, interrupt, 3)
    with pytest.raises(KeyboardInterrupt):
        drive()


def test_without_a_detector_a_look_is_of_the_state_at_its_exposure(monkeypatch: pytest.MonkeyPatch) -> None:
    """It is made when its boxes are due, `camera.latency_s` later, when the car is elsewhere."""
    true_eye, seen = eyes.true_box_source, []

    def recorded(*given: object) -> BoxSource:
        inner = true_eye(*given)  # type: ignore[arg-type]

        def look(tick: int, state: VehicleState, first_row: int) -> Exposure:
            seen.append((tick, float(state.time_s)))
            return inner(tick, state, first_row)

        return look

    monkeypatch.setattr(eyes, "true_box_source", recorded)
    drive()
    assert len(seen) > 10
    assert [time_s for _, time_s in seen] == pytest.approx([tick / TICKS_PER_SECOND for tick, _ in seen])


def test_the_estimator_takes_off_the_default_bias_of_simulated_boxes(monkeypatch: pytest.MonkeyPatch) -> None:
    """Also when the shipped weights have another one."""
    build, given = eyes.build_estimator, []
    monkeypatch.setattr(eyes, "build_estimator", lambda *told: given.append(told[1]) or build(*told))
    scenario = load("bump_8x40_30")
    eyes.build_boxes(Drive(scenario, (), 0))
    ((bump, pothole),) = given
    assert (bump.top_bias_px, pothole.top_bias_px) == scenario.boxes.top_bias_px
    assert (bump.bottom_bias_px, pothole.bottom_bias_px) == scenario.boxes.bottom_bias_px
