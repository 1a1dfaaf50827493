import numpy as np
import pytest
from scipy.signal import StateSpace, lsim

from foreride.comfort.weighting import wk_second_order
from foreride.controller.weighting_states import ComfortFilter
from foreride.vehicle.load import load_vehicle


@pytest.mark.parametrize("name", ["quarter", "half"])
def test_follows_the_filter_for_a_known_motion(name: str) -> None:
    """Seat oscillating at 3 Hz: the states agree with lsim on the exact acceleration."""
    vehicle = load_vehicle(name)
    times, omega = 0.01 * np.arange(200), 2 * np.pi * 3
    follower = ComfortFilter(vehicle, 0.01)
    x = np.zeros(10 if vehicle.wheels == 2 else 5)
    states = []
    for t in times:
        x[1] = 0.1 * (1 - np.cos(omega * t))
        states.append(follower.update(x).reshape(-1, 2))
    a, b, c = wk_second_order().state_space()
    fine = np.arange(0, times[-1], 1e-4)
    exact = lsim(StateSpace(a, b[:, None], c[None], 0.0), 0.1 * omega * np.sin(omega * fine), fine)[1]
    weighted = np.array(states) @ c
    for seat in range(len(vehicle.seat_x_m)):
        np.testing.assert_allclose(
            weighted[:, seat], np.interp(times, fine, exact), atol=0.05 * np.abs(exact).max()
        )


def test_seats_feel_pitch_by_their_distance() -> None:
    vehicle = load_vehicle("half")
    follower = ComfortFilter(vehicle, 0.01)
    follower.update(np.zeros(10))
    x = np.zeros(10)
    x[3] = 0.2
    states = follower.update(x).reshape(-1, 2)
    ratio = states[0] / states[1]
    np.testing.assert_allclose(ratio, vehicle.seat_x_m[0] / vehicle.seat_x_m[1])
