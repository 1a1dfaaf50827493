"""Tests of the oracle: exact by default, with prescribed errors otherwise."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from foreride.files.errors import InputError
from foreride.preview.road_preview import RoadPreview, oracle_preview
from foreride.road.features.feature import HalfSineBump
from foreride.road.road import Road
from foreride.road.roughness.iso8608 import Roughness
from foreride.road.tyre.wheel_profile import wheel_profile
from foreride.road.vertical_alignment import GradeChange
from foreride.scenarios.definition.loading import load
from foreride.scenarios.definition.oracle_errors import OracleErrors
from foreride.scenarios.perceptions.interface import Drive
from foreride.scenarios.perceptions.oracle import (
    OraclePerception,
    believed_road,
    build_obstacles,
    build_oracle,
)
from foreride.vehicle.equations import rest_state
from foreride.vehicle.load import load_vehicle

CAR = load_vehicle("half")
ROAD = Road(80.0, (HalfSineBump(30.0, 0.05, 0.5), HalfSineBump(60.0, 0.05, 0.5)), Roughness("A", 1))
SCENARIO = load("bump_8x40_30", ["vehicle.model=half"])
PROFILES = [wheel_profile(ROAD, -0.75)] * 2


def oracle(errors: OracleErrors, road: Road = ROAD) -> OraclePerception:
    scenario = replace(SCENARIO, road=road, oracle=errors)
    return build_oracle(Drive(scenario, [wheel_profile(road, -0.75)] * 2, seed=4))


def state_at(x_m: float, climb_m_s: float = 0.0) -> Any:
    """State of a car that rides along its plane at 10 m/s, as far as the oracle reads it."""
    x = rest_state(CAR)
    x[1] = climb_m_s
    return SimpleNamespace(x_m=x_m, speed_m_s=10.0, x=x)


def seen(errors: OracleErrors, x_m: float = 26.0, road: Road = ROAD) -> RoadPreview:
    return oracle(errors, road).preview(0.0, state_at(x_m))


def crest(preview: RoadPreview) -> float:
    """Distance of the middle of the stretch higher than 3 cm from the front wheel, m."""
    return float(preview.distance_m[preview.height_m[0] > 0.03].mean())


SMOOTH = Road(80.0, (HalfSineBump(30.0, 0.05, 0.5),))


def test_without_errors_it_is_the_true_road_over_the_plane_and_says_so() -> None:
    expected = oracle_preview(PROFILES, 26.0 + np.array(CAR.axle_x_m), 0.0).height_m
    found = seen(OracleErrors())
    zero = int(np.flatnonzero(np.isclose(found.distance_m, 0.0))[0])
    np.testing.assert_allclose(found.height_m, expected - expected[:, zero : zero + 1], atol=1e-12)
    assert found.position_sigma_m.max() == found.age_s == 0.0
    assert found.existence.min() == 1.0


def test_a_steady_climb_is_not_in_the_preview() -> None:
    climbing = Road(80.0, SMOOTH.features, grades=(GradeChange(0.0, 0.06, 2.0),))
    level = oracle(OracleErrors(), SMOOTH).preview(0.0, state_at(26.0))
    found = oracle(OracleErrors(), climbing).preview(0.0, state_at(26.0, climb_m_s=0.6))
    # The tyre's envelope leans with the road, so the bump shifts by R·0.06.
    np.testing.assert_allclose(found.height_m, level.height_m, atol=0.01)


@pytest.mark.parametrize("bias", [-0.5, 0.2])
def test_bias_puts_features_farther_ahead(bias: float) -> None:
    assert crest(seen(OracleErrors(bias_m=bias), road=SMOOTH)) - crest(
        seen(OracleErrors(), road=SMOOTH)
    ) == pytest.approx(bias, abs=0.03)


def test_height_and_confession_are_as_told() -> None:
    errors = OracleErrors(height_gain=1.3, position_sigma_m=0.1, height_sigma=0.2, existence=0.7)
    true, found = seen(OracleErrors()), seen(errors)
    np.testing.assert_allclose(found.height_m, 1.3 * true.height_m)
    np.testing.assert_allclose(found.height_sigma_m, 0.2 * np.abs(found.height_m))
    assert np.unique(found.position_sigma_m) == 0.1
    assert np.unique(found.existence) == 0.7


@pytest.mark.parametrize("speed_error", [0.0, 0.01])
def test_an_old_view_is_carried_forward_by_the_measured_speed(speed_error: float) -> None:
    """10 m/s and 0.15 s: an error of 1 % in speed misplaces the road by 15 mm."""
    late = oracle(OracleErrors(latency_s=0.15), SMOOTH)
    for step in range(60):
        time_s = 0.005 * step
        x_m = 25.0 + 10.0 * time_s
        late.sense(SimpleNamespace(speed_m_s=10.0 * (1.0 + speed_error)))  # type: ignore[arg-type]
        found = late.preview(time_s, state_at(x_m))
    profiles = [profile for profile, _ in late._tracks]
    believed = oracle_preview(profiles, x_m + 1.5 * speed_error + np.array(CAR.axle_x_m))
    np.testing.assert_allclose(found.height_m, believed.height_m, atol=1e-6)
    assert found.age_s == 0.15


def test_what_is_missed_is_not_there_while_roughness_is() -> None:
    blind = believed_road(ROAD, 1.5, OracleErrors(miss_probability=1.0), np.random.default_rng(0))
    assert blind.features == ()
    assert blind.roughness == ROAD.roughness


def test_without_roughness_the_features_alone_are_seen_and_the_rest_has_the_background_sigma() -> None:
    errors = OracleErrors(roughness=False, height_sigma=0.3)
    found, smooth = seen(errors), seen(OracleErrors(), road=replace(ROAD, roughness=None))
    np.testing.assert_allclose(found.height_m, smooth.height_m, atol=1e-12)
    background_m = SCENARIO.estimator.background_sigma_m
    np.testing.assert_allclose(found.height_sigma_m, np.hypot(0.3 * smooth.height_m, background_m))


def test_measured_heights_are_not_seen_without_roughness(tmp_path: Path) -> None:
    surface = tmp_path / "road.csv"
    surface.write_text("x_m,z_m\n" + "".join(f"{x},{0.02 * (x > 20)}\n" for x in range(41)))
    road = Road(40.0, (HalfSineBump(30.0, 0.05, 0.5),), file=str(surface))
    believed = believed_road(road, 1.5, OracleErrors(roughness=False), np.random.default_rng(0))
    assert believed == Road(40.0, road.features)


def test_the_perception_of_obstacles_is_the_oracle_without_roughness() -> None:
    drive = Drive(replace(SCENARIO, road=ROAD), PROFILES, seed=4)
    found = build_obstacles(drive).preview(0.0, state_at(26.0))
    expected = seen(OracleErrors(roughness=False))
    np.testing.assert_array_equal(found.height_m, expected.height_m)
    np.testing.assert_array_equal(found.height_sigma_m, expected.height_sigma_m)


def test_features_are_imagined_at_the_rate_told() -> None:
    rng = np.random.default_rng(2)
    errors = OracleErrors(false_per_100m=2.0)
    counts = [len(believed_road(ROAD, 1.5, errors, rng).features) - len(ROAD.features) for _ in range(400)]
    assert np.mean(counts) == pytest.approx(1.6, abs=4 * np.sqrt(1.6 / 400))


def test_the_same_chance_gives_the_same_belief() -> None:
    errors = OracleErrors(miss_probability=0.5, false_per_100m=2.0)
    first, again = (believed_road(ROAD, 1.5, errors, np.random.default_rng(7)) for _ in range(2))
    assert first == again


@pytest.mark.parametrize(
    ("field", "value"), [("latency_s", -0.1), ("existence", 1.2), ("bias_m", float("nan"))]
)
def test_errors_out_of_range_are_refused(field: str, value: float) -> None:
    with pytest.raises(InputError, match=f"^{field} must lie in"):
        OracleErrors(**{field: value})
