"""Tests of elevation perceptions in the loop: every car and sensor, and what rate and latency mean."""

import numpy as np
import pytest

from foreride.files.errors import InputError
from foreride.preview.elevation.range_sensor import PRESETS, Lidar64, Stereo30cm
from foreride.preview.road_preview import RoadPreview
from foreride.road.tyre.wheel_profile import wheel_profile
from foreride.scenarios.cases import Case
from foreride.scenarios.definition.loading import load
from foreride.scenarios.definition.schema import Scenario
from foreride.scenarios.perceptions.elevation import ElevationPerception, RangeScanner, build_elevation
from foreride.scenarios.perceptions.interface import Drive
from foreride.scenarios.simulation.simulate import simulate
from foreride.vehicle.plant.sensors import Measurement

SHORT = ["road.length_m=24", "road.features.0.start_m=14"]


def state(x_m: float = 2.0) -> object:
    class State:
        def __init__(self) -> None:
            self.x_m, self.heave_m, self.pitch_rad, self.roll_rad = x_m, 0.0, 0.0, 0.0

    return State()


def scanner(scenario: Scenario, seed: int = 0) -> RangeScanner:
    return RangeScanner(scenario.road, scenario.elevation.sensor, Drive(scenario, [], seed), 12.0)


def rolled(scenario: Scenario, until_m: float) -> tuple[ElevationPerception, RoadPreview, float]:
    """Perception, its last preview and the position of a car that rolls at constant speed."""
    perception, car = build_elevation(Drive(scenario, [], 0)), scenario.vehicle.parameters
    zeros = np.zeros(car.wheels)
    for tick in range(0, int((until_m - 2.0) / scenario.speed_m_s * 1000), 5):
        here = state(2.0 + tick / 1000 * scenario.speed_m_s)
        perception.expose(tick, here)  # type: ignore[arg-type]
        perception.sense(Measurement(tick / 1000, zeros, zeros, zeros, 0.0, scenario.speed_m_s))
        perception.receive(tick)
        preview = perception.preview(tick / 1000, here)  # type: ignore[arg-type]
    assert preview is not None
    return perception, preview, 2.0 + tick / 1000 * scenario.speed_m_s


@pytest.mark.parametrize("model", ["quarter", "half", "full"])
def test_every_car_sees_the_bump_before_each_wheel(model: str) -> None:
    sensor = "elevation.sensor.kind=stereo_30cm"
    scenario = load("bump_8x40_30", [*SHORT, f"vehicle.model={model}", sensor])
    car = scenario.vehicle.parameters
    perception, preview, x_m = rolled(scenario, 14.0 - max(car.axle_x_m) - 2.0)
    assert preview.wheels == car.wheels
    for wheel, (axle, y) in enumerate(zip(car.axle_x_m, car.wheel_y_m, strict=True)):
        profile = wheel_profile(scenario.road, y, car.wheel_radius_m, scenario.enveloping)
        from_front = max(car.axle_x_m) - axle
        near = (preview.distance_m > from_front + 1.0) & (preview.distance_m < from_front + 4.0)
        true = profile.height(x_m + axle + preview.distance_m)[near]
        error, sigma = preview.height_m[wheel][near] - true, preview.height_sigma_m[wheel][near]
        seen = sigma < 0.005
        assert true.max() > 0.07
        assert error[seen].std() < 0.006
        assert sigma[~seen].max() > 0.01  # the road behind the bump is hidden
        assert seen.mean() > 0.8
    assert perception.stats()["scans"] >= 15
    assert perception.timing()["fusion_median_ms"] > 0.0


def test_a_drive_is_repeatable_and_better_than_a_blind_one() -> None:
    scenario = load("bump_8x40_30", [*SHORT, "vehicle.model=quarter"])
    first, second, blind = (
        simulate(Case(scenario, "mpc_preview", name, 0)).metrics["objective"]
        for name in ("stereo_30cm", "stereo_30cm", "none")
    )
    assert first == second
    assert first < 0.995 * blind


def test_other_seeds_give_other_points() -> None:
    scenario = load("bump_8x40_30", SHORT)
    first, again, other = (scanner(scenario, seed).scan(state()) for seed in (0, 0, 1))  # type: ignore[arg-type]
    assert np.array_equal(first, again)
    assert not np.array_equal(first, other)


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
