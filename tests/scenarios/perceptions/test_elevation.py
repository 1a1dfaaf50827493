"""Tests of elevation perceptions in the loop: every car and sensor, and what rate and latency mean."""

import numpy as np
import pytest

from foreride.files.errors import InputError
from foreride.preview.elevation.range_sensor import PRESETS, Lidar64, Stereo30cm
from foreride.scenarios.cases import Case
from foreride.scenarios.definition.loading import load
from foreride.scenarios.definition.schema import Scenario
from foreride.scenarios.perceptions.elevation import RangeScanner, build_elevation
from foreride.scenarios.perceptions.interface import Drive
from foreride.scenarios.simulation.simulate import Run, simulate

SHORT = ["road.length_m=24", "road.features.0.start_m=14"]


def drive(perception: str, *overrides: str, controller: str = "mpc_preview") -> Run:
    return simulate(Case(load("bump_8x40_30", [*SHORT, *overrides]), controller, perception, 0))


def state(x_m: float = 2.0) -> object:
    class State:
        def __init__(self) -> None:
            self.x_m, self.heave_m, self.pitch_rad, self.roll_rad = x_m, 0.0, 0.0, 0.0

    return State()


def scanner(scenario: Scenario, seed: int = 0) -> RangeScanner:
    return RangeScanner(scenario.road, scenario.elevation.sensor, Drive(scenario, [], seed), 12.0)


@pytest.mark.parametrize("model", ["quarter", "half", "full"])
def test_every_car_gains_by_a_stereo_camera(model: str) -> None:
    car = f"vehicle.model={model}"
    blind = drive("none", car).metrics["objective"]
    run = drive("stereo_30cm", car)
    assert run.metrics["objective"] < 0.995 * blind
    assert run.perception["scans"] == pytest.approx(20 * run.signals["time_s"][-1], abs=1)


def test_the_same_seed_gives_the_same_drive_and_another_seed_another() -> None:
    scenario = load("bump_8x40_30", [*SHORT, "vehicle.model=quarter"])
    first, second, other = (
        simulate(Case(scenario, "mpc_preview", "lidar_64", seed)).metrics["objective"] for seed in (0, 0, 1)
    )
    assert first == second
    assert first != other


def test_the_perception_elevation_has_the_sensor_of_the_scenario() -> None:
    scenario = load("bump_8x40_30", ["elevation.sensor={kind: lidar_64, rate_hz: 5}"])
    assert scenario.elevation.sensor == Lidar64(rate_hz=5)
    assert build_elevation(Drive(scenario, [], 0)).next_tick(0) == 200
    assert build_elevation(Drive(scenario, [], 0), Stereo30cm).next_tick(0) == 50


def test_points_arrive_after_the_latency() -> None:
    scenario = load("bump_8x40_30", ["elevation.sensor={kind: lidar_64, latency_s: 0.03}"])
    perception = build_elevation(Drive(scenario, [], 0))
    perception.expose(0, state())  # type: ignore[arg-type]
    assert perception.next_tick(0) == 30
    perception.receive(29)
    assert perception.stats()["scans"] == 0


@pytest.mark.parametrize("preset", PRESETS)
def test_points_scatter_about_the_road_as_the_data_sheet_says(preset: type) -> None:
    options = f"elevation.sensor={{kind: {preset.kind}, pitch_sigma_deg: 0, roll_sigma_deg: 0}}"  # type: ignore[attr-defined]
    scenario = load("bump_8x40_30", [options])
    sensor = scenario.elevation.sensor
    points = scanner(scenario).scan(state())  # type: ignore[arg-type]
    distance = np.linalg.norm(points, axis=1)
    ahead = np.deg2rad(sensor.pitch_deg)
    height = sensor.height_m - np.sin(ahead) * points[:, 0] + np.cos(ahead) * points[:, 2]
    expected = np.hypot(
        sensor.range_sigma_m(distance) * sensor.height_m / distance, sensor.direction_sigma_rad * distance
    )
    assert len(points) > 3000
    assert (height / expected).std() == pytest.approx(1.0, abs=0.1)
    assert np.abs(height.mean()) < 0.1 * expected.mean() + 1e-3


def test_dropout_and_range_leave_points_out() -> None:
    kinds = (
        "{kind: lidar_64, dropout: 0}",
        "{kind: lidar_64, dropout: 0.5}",
        "{kind: lidar_64, max_range_m: 8}",
    )
    scans = [
        scanner(load("bump_8x40_30", [f"elevation.sensor={kind}"])).scan(state())  # type: ignore[arg-type]
        for kind in kinds
    ]
    assert len(scans[1]) == pytest.approx(0.5 * len(scans[0]), rel=0.05)
    assert np.linalg.norm(scans[2], axis=1).max() < 8.2


def test_an_unknown_sensor_is_refused() -> None:
    with pytest.raises(InputError, match=r"elevation\.sensor.*lidar_64, lidar_solid_state, stereo_30cm"):
        load("bump_8x40_30", ["elevation.sensor={kind: radar}"])
