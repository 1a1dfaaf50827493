import numpy as np
import pytest

from foreride.road.tyre.wheel_profile import WheelProfile
from foreride.vehicle import equations
from foreride.vehicle.load import load_vehicle
from foreride.vehicle.state import observe, road_under, signal_unit

QUARTER, HALF = load_vehicle("quarter"), load_vehicle("half")
RAMP = WheelProfile(0.0, 1.0, np.array([0.0, 0.0, 0.0, 0.0, 0.1, 0.2, 0.3]))


def test_each_wheel_sees_the_road_at_its_own_place() -> None:
    height, velocity = road_under(HALF, [RAMP, RAMP], 3.5, 10.0)
    assert height == pytest.approx([0.175, 0.0])  # front at 4.75, rear at 2.05
    assert velocity == pytest.approx([1.0, 0.0])


def test_seats_move_with_the_rigid_body() -> None:
    x = equations.rest_state(HALF)
    x[4:8:2] = 0.02, -0.01
    state = observe(HALF, 0.0, 0.0, 10.0, x.tolist(), x[-2:], ([0.0, 0.0], [0.0, 0.0]))
    between = np.interp(HALF.seat_x_m, HALF.axle_x_m[::-1], state.body_acc[::-1])
    np.testing.assert_allclose(state.seat_acc, between)
    assert state.cg_acc == pytest.approx(np.interp(0.0, HALF.axle_x_m[::-1], state.body_acc[::-1]))


def test_a_quarter_car_does_not_pitch() -> None:
    x = equations.rest_state(QUARTER)
    x[2] = 0.02
    state = observe(QUARTER, 0.0, 0.0, 10.0, x.tolist(), x[-1:], ([0.0], [0.0]))
    assert state.pitch_rad == state.pitch_rate == state.pitch_acc == 0.0
    assert state.body_acc[0] == state.seat_acc[0] == state.cg_acc != 0.0


def test_wheel_and_body_forces_balance() -> None:
    """Newton's law for the whole car: tyre forces minus weight accelerate all masses."""
    rng = np.random.default_rng(2)
    x = rng.normal(0, 0.05, (10, 50))
    x[-2:] = 2000.0
    road = (list(rng.normal(0, 0.02, (2, 50))), list(rng.normal(0, 0.5, (2, 50))))
    time = np.arange(50.0)
    state = observe(HALF, time, time, time, x, x[-2:], road)
    inertia = 800 * state.cg_acc + 42 * state.wheel_acc.sum(axis=0)
    np.testing.assert_allclose(inertia, (state.tyre_force - state.static_tyre_force).sum(axis=0), atol=1e-6)


@pytest.mark.parametrize(
    ("name", "unit"), [("seat_acc_0", "m/s²"), ("seat_acc", "m/s²"), ("x_m", "m"), ("tyre_force_3", "N")]
)
def test_a_signal_has_its_unit_with_and_without_an_index(name: str, unit: str) -> None:
    assert signal_unit(name) == unit


def test_an_unknown_signal_has_none() -> None:
    with pytest.raises(KeyError):
        signal_unit("seat_0_acc")
