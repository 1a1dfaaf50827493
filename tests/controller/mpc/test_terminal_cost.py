import numpy as np
import pytest

from foreride.controller.command_limits import KILO, DampingLimits
from foreride.controller.mpc.terminal_cost import terminal_cost
from foreride.controller.prediction.prediction_model import KNOWN, prediction_model
from foreride.vehicle.equations import rest_state
from foreride.vehicle.load import load_vehicle


@pytest.mark.parametrize("name", ["quarter", "half"])
def test_it_is_the_cost_of_coming_to_rest(name: str) -> None:
    """Cost over six seconds with passive dampers after a small disturbance equals the terminal cost."""
    vehicle = load_vehicle(name)
    model = prediction_model(vehicle)
    cost = terminal_cost(model, 0.005)
    rng = np.random.default_rng(0)
    rest = np.concatenate([rest_state(vehicle), np.zeros(2 * len(vehicle.seat_x_m))])
    state = rest + np.where(rest > 0, 0.0, 1e-3) * rng.normal(size=model.n_x)
    promised = np.sum((cost.root @ state) ** 2)
    passive = DampingLimits.of(vehicle).passive / KILO
    total = 0.5 * float(np.sum(np.array(model.outputs(state, KNOWN)) ** 2))  # trapezoidal rule
    for _ in range(1200):
        state = np.array(model.step(state, passive, 0.0, 0.0, 0.005, KNOWN))[:, 0]
        total += float(np.sum(np.array(model.outputs(state, KNOWN)) ** 2))
    assert total == pytest.approx(promised, rel=0.02)


@pytest.mark.parametrize("name", ["quarter", "half"])
def test_rest_on_any_road_costs_nothing(name: str) -> None:
    vehicle = load_vehicle(name)
    model = prediction_model(vehicle)
    cost = terminal_cost(model, 0.01)
    road = np.array([0.05, -0.03])[: vehicle.wheels]
    state = cost.rest @ road
    state[: len(rest_state(vehicle))] += rest_state(vehicle)
    assert np.abs(cost.root @ (state - cost.rest @ road)).max() < 1e-9
    still = model.step(state, DampingLimits.of(vehicle).passive / KILO, road, road, 0.005, KNOWN)
    np.testing.assert_allclose(np.array(still)[:, 0], state, atol=1e-9)
