"""The gate on previews that do not come true, on roads whose true shape is known."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from foreride.controller.settings import GateSettings
from foreride.controller.supervision.preview_gate import PreviewGate
from foreride.preview.road_preview import RoadPreview, distance_grid, flat_preview
from foreride.vehicle.load import load_vehicle
from tests.controller.cars import estimate

CAR = load_vehicle("half")
SPEED, PERIOD = 10.0, 0.005
FIRST_M, SECOND_M, END_M = 10.0, 30.0, 60.0

Road = Callable[[np.ndarray], np.ndarray]


def bump(start_m: float, height_m: float = 0.08, length_m: float = 0.6) -> Road:
    def height(x: np.ndarray) -> np.ndarray:
        return height_m * np.sin(np.pi * np.clip((x - start_m) / length_m, 0.0, 1.0))

    return height


def flat(x: np.ndarray) -> np.ndarray:
    return np.zeros_like(x)


def drive(
    road: Road,
    claimed: Road,
    sigma_m: float = 0.0,
    noise_m: float = 0.001,
    seed: int = 0,
    gate: PreviewGate | None = None,
) -> tuple[np.ndarray, np.ndarray]:
    """Places of the front axle, and whether the preview was used there."""
    rng, grid = np.random.default_rng(seed), distance_grid(0.5, 4.0)
    gate = gate or PreviewGate(CAR, GateSettings())
    places = np.arange(0.0, END_M, SPEED * PERIOD)
    used = []
    for k, place in enumerate(places):
        felt = float(road(np.array([place]))[0]) + noise_m * float(rng.standard_normal())
        now = replace(estimate(CAR, road=felt, speed_m_s=SPEED), time_s=k * PERIOD)
        heights = np.tile(claimed(place + grid), (CAR.wheels, 1))
        nothing = np.zeros_like(heights)
        seen = RoadPreview(k * PERIOD, grid, heights, nothing + sigma_m, nothing, nothing + 1.0)
        used.append(gate.check(now, seen) is None)
    return places, np.array(used)


def rough(seed: int, size_m: float = 0.004) -> Road:
    """Smooth random road of about this standard deviation, its waves 1 to 6 m long."""
    rng = np.random.default_rng(seed)
    waves, phases = 2.0 * np.pi / rng.uniform(1.0, 6.0, 20), rng.uniform(0.0, 2.0 * np.pi, 20)

    def height(x: np.ndarray) -> np.ndarray:
        return size_m * np.sqrt(0.1) * np.sin(np.multiply.outer(x, waves) + phases).sum(axis=-1)

    return height


def plus(*roads: Road) -> Road:
    return lambda x: np.sum([road(x) for road in roads], axis=0)


TWO = plus(bump(FIRST_M), bump(SECOND_M))


@pytest.mark.parametrize("claimed", [TWO, plus(bump(FIRST_M, 0.065), bump(SECOND_M, 0.095))])
def test_a_preview_that_comes_true_is_used_throughout(claimed: Road) -> None:
    assert drive(TWO, claimed)[1].all()


@pytest.mark.parametrize("shift_m", [-0.05, 0.05])
def test_errors_of_a_few_centimetres_along_the_road_are_forgiven(shift_m: float) -> None:
    assert drive(TWO, plus(bump(FIRST_M + shift_m), bump(SECOND_M + shift_m)))[1].all()


def test_a_claimed_sigma_is_forgiven() -> None:
    shifted = plus(bump(FIRST_M + 0.12), bump(SECOND_M + 0.12))
    assert not drive(TWO, shifted)[1].all()
    assert drive(TWO, shifted, sigma_m=0.12)[1].all()


@pytest.mark.parametrize(
    "claimed",
    [
        bump(FIRST_M - 0.3),
        bump(FIRST_M + 0.3),
        bump(FIRST_M, 0.24),
        bump(FIRST_M, -0.08),
        plus(bump(FIRST_M), bump(FIRST_M + 2.0, 0.06)),
    ],
    ids=["early", "late", "three times too high", "mirrored", "phantom"],
)
def test_one_strike_that_contradicts_ends_the_use_of_a_preview(claimed: Road) -> None:
    places, used = drive(bump(FIRST_M), claimed)
    assert used[places < FIRST_M - 0.4].all()
    assert not used[(places > FIRST_M + 2.7) & (places < SECOND_M)].any()


@pytest.mark.parametrize(("shift_m", "by_m"), [(-0.3, -0.1), (0.3, 0.15)], ids=["early", "late"])
def test_a_wrong_place_is_noticed_at_the_first_edge(shift_m: float, by_m: float) -> None:
    places, used = drive(bump(FIRST_M), bump(FIRST_M + shift_m))
    assert places[~used][0] < FIRST_M + by_m


def test_a_missed_obstacle_sets_the_preview_aside_for_a_metre_and_costs_no_trust() -> None:
    places, used = drive(TWO, bump(SECOND_M))
    assert not used[(places > FIRST_M + 0.2) & (places < FIRST_M + 1.0)].any()
    assert used[places > FIRST_M + 2.0].all()


def test_trust_comes_back_with_time_and_only_above_the_higher_level() -> None:
    """Half of it is lost; half of the rest is regained in a half-life, four fifths in 1.32 of them."""
    places, used = drive(flat, bump(FIRST_M, 0.04), gate=PreviewGate(CAR, GateSettings(half_life_s=1.5)))
    lost = places[~used]
    assert (lost[-1] - lost[0]) / SPEED == pytest.approx(1.5 * np.log2(0.5 / 0.2), abs=0.1)


def test_a_second_lie_costs_more_than_the_first() -> None:
    settings = GateSettings(half_life_s=1.0)
    both = drive(flat, plus(bump(FIRST_M), bump(SECOND_M)), gate=PreviewGate(CAR, settings))[1]
    assert (~both).sum() > 2.05 * (~drive(flat, bump(FIRST_M), gate=PreviewGate(CAR, settings))[1]).sum()


def test_another_roads_texture_is_noticed_and_the_true_one_is_not() -> None:
    places, used = drive(rough(1), rough(2))
    assert not used[places > 15.0].any()
    assert drive(rough(1), rough(1))[1].all()


@pytest.mark.parametrize("seed", range(20))
def test_noise_and_an_unseen_rough_road_are_no_reason(seed: int) -> None:
    claimed = bump(FIRST_M)
    road = plus(claimed, rough(seed, 0.003))
    assert drive(road, claimed, noise_m=0.002, seed=seed)[1].all()


def test_a_wheel_in_the_air_tells_nothing() -> None:
    gate, grid = PreviewGate(CAR, GateSettings()), distance_grid(0.5, 4.0)
    heights = np.full((CAR.wheels, len(grid)), 0.08)
    nothing = np.zeros_like(heights)
    for k in range(50):
        now = replace(estimate(CAR, road=-0.1 * k, contact=False), time_s=k * PERIOD)
        seen = RoadPreview(k * PERIOD, grid, heights, nothing, nothing, nothing + 1.0)
        assert gate.check(now, seen) is None


def test_an_obstacle_passed_while_nothing_was_known_is_no_contradiction() -> None:
    """A gap, as while sensors fail, in which the car drives onto an obstacle and the observer loses its
    level.
    """
    gate, grid = PreviewGate(CAR, GateSettings()), distance_grid(0.5, 4.0)
    step = bump(FIRST_M, height_m=0.1, length_m=20.0)
    for time_s in (*np.arange(0.0, 0.9, PERIOD), *np.arange(2.0, 3.0, PERIOD)):
        place = SPEED * time_s
        lost_m = 0.3 if time_s > 1.0 else 0.0
        now = replace(
            estimate(CAR, road=float(step(np.array([place]))[0]) + lost_m, speed_m_s=SPEED), time_s=time_s
        )
        heights = np.tile(step(place + grid), (CAR.wheels, 1))
        nothing = np.zeros_like(heights)
        assert gate.check(now, RoadPreview(time_s, grid, heights, nothing, nothing, nothing + 1.0)) is None


def test_a_hole_that_was_announced_is_no_reason() -> None:
    assert drive(bump(FIRST_M, -0.08), bump(FIRST_M, -0.08))[1].all()


@pytest.mark.parametrize(
    ("road", "claimed"),
    [
        (flat, bump(FIRST_M)),
        (bump(FIRST_M), flat),
        (bump(FIRST_M), bump(FIRST_M, 0.03)),
        (rough(1), rough(2)),
    ],
    ids=["missing", "unannounced", "too low", "other texture"],
)
def test_holes_are_judged_like_bumps(road: Road, claimed: Road) -> None:
    """Road and preview upside down: the same decisions at the same places."""
    upright = drive(road, claimed, noise_m=0.0)[1]
    turned = drive(lambda x: -road(x), lambda x: -claimed(x), noise_m=0.0)[1]
    np.testing.assert_array_equal(turned, upright)


def test_a_place_is_tolerated_as_far_early_as_late() -> None:
    """6 cm, and as much as the edge's own slope within the tolerated height."""
    assert all(drive(bump(FIRST_M), bump(FIRST_M + shift), noise_m=0.0)[1].all() for shift in (-0.09, 0.09))
    for shift in (-0.15, 0.15):
        places, used = drive(bump(FIRST_M), bump(FIRST_M + shift), noise_m=0.0)
        assert places[~used][0] < FIRST_M + 0.2


@pytest.mark.parametrize(("gap_s", "compared"), [(0.15, True), (0.2, False)])
def test_samples_up_to_fifteen_hundredths_of_a_second_apart_are_compared(
    gap_s: float, compared: bool
) -> None:
    """After a longer gap a step of 5 cm under the wheel is the beginning of another comparison."""
    gate, plain = PreviewGate(CAR, GateSettings()), flat_preview(2, distance_m=distance_grid(0.5, 4.0))
    felt = estimate(CAR, speed_m_s=0.01)
    assert gate.check(felt, plain) is None
    later = replace(felt, time_s=gap_s, road_height=np.full(2, 0.05))
    assert (gate.check(later, plain) is not None) == compared
