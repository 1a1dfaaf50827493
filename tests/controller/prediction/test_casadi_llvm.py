"""Tests of compiled functions against CasADi's own evaluation."""

from pathlib import Path
from unittest.mock import Mock

import casadi
import numpy as np
import pytest

from foreride.controller.prediction import casadi_llvm
from foreride.controller.prediction.casadi_llvm import CompiledFunction, _module, evaluate
from foreride.controller.prediction.prediction_model import prediction_model
from foreride.vehicle.load import load_vehicle

A, B = casadi.SX.sym("a"), casadi.SX.sym("b")
EXPRESSIONS = {
    "sum": A + B,
    "difference": A - B,
    "product": A * B,
    "quotient": A / B,
    "negative": -A,
    "square": A**2,
    "double": 2 * A,
    "inverse": 1 / A,
    "constant": A * 0 + 0.1,
    "least": casadi.fmin(A, B),
    "most": casadi.fmax(A, B),
    "magnitude": casadi.fabs(A),
    "root": casadi.sqrt(A * A + 1),
    "exponential": casadi.exp(A),
    "logarithm": casadi.log(A * A + 1),
    "hyperbolic tangent": casadi.tanh(A),
    "less": A < B,
    "at most": A <= B,
    "equal": A == B,
    "other": A != B,
    "not": casadi.logic_not(A),
    "choice": casadi.if_else(A > B, 3 * A, B),
}
VALUES = np.array([[1.5, -2.0, 0.0, 3.0, -0.0, 7.0, 1.0, 1e-9], [0.5, 4.0, 1.0, 3.0, 2.0, -1e9, 1.0, -1.0]])


@pytest.mark.parametrize("lanes", [1, 4, 8])
@pytest.mark.parametrize("name", EXPRESSIONS)
def test_every_operation_gives_what_casadi_gives(name: str, lanes: int) -> None:
    function = casadi.Function("f", [A, B], [EXPRESSIONS[name]])
    results = np.full((1, 8), np.nan)
    CompiledFunction(function, lanes)(VALUES, results, 8)
    np.testing.assert_allclose(results[0], np.array(function(*VALUES[:, None, :]))[0], rtol=1e-15)


def test_an_unknown_operation_is_refused() -> None:
    with pytest.raises(NotImplementedError, match="f has no translation"):
        CompiledFunction(casadi.Function("f", [A], [casadi.erf(A)]))


@pytest.mark.parametrize("name", ["quarter", "half"])
def test_slopes_of_the_car_are_the_same_to_the_last_bit(name: str) -> None:
    model = prediction_model(load_vehicle(name))
    rng = np.random.default_rng(0)
    points = rng.normal(size=(model.linearise.rows_in, 8))
    points[-3] = 0.005
    points[-2:] = [[1.2], [0.8]]
    results = np.empty((model.linearise.rows_out, 8))
    model.linearise(points, results, 8)
    wheels = model.vehicle.wheels
    parts = np.split(points, np.cumsum([model.n_x, wheels, wheels, wheels, 1]))
    for point in range(8):
        outputs = model.slopes(*(part[:, point] for part in parts))
        expected = np.concatenate([output.nonzeros() for output in outputs])
        np.testing.assert_array_equal(results[:, point], expected)


def test_compiled_functions_call_a_kernel_by_its_address() -> None:
    """Of views of larger arrays, whose other entries stay as they are."""
    kernel = CompiledFunction(casadi.Function("f", [A, B], [A * B, A - B]), 4)
    results = np.full((2, 12), np.nan)
    evaluate(kernel.address, VALUES, results[:, 2:], 8)
    np.testing.assert_array_equal(results[:, 2:10], [VALUES[0] * VALUES[1], VALUES[0] - VALUES[1]])
    assert np.isnan(results[:, [0, 1, 10, 11]]).all()


def test_cached_code_serves_the_same_function_with_the_same_lanes_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("FORERIDE_CACHE", str(tmp_path))
    product, quotient = (casadi.Function("f", [A, B], [value]) for value in (A * B, A / B))
    expected = np.array([VALUES[0] * VALUES[1], VALUES[0] / VALUES[1]])
    for lanes_compiled in ([4, 4, 8, 8], []):
        translated = Mock(wraps=_module)
        monkeypatch.setattr(casadi_llvm, "_module", translated)
        for lanes in (4, 8):
            for function, row in zip((product, quotient), expected, strict=True):
                results = np.full((1, 8), np.nan)
                CompiledFunction(function, lanes)(VALUES, results, 8)
                np.testing.assert_array_equal(results[0], row)
        assert [call.args[1] for call in translated.call_args_list] == lanes_compiled


def test_one_lane_steps_from_point_to_point() -> None:
    """A geometric series, each term made from the one before."""
    double = CompiledFunction(casadi.Function("f", [A], [2 * A]))
    series = np.array([[3.0, 0.0, 0.0, 0.0]])
    double(series, series[:, 1:], 3)
    np.testing.assert_array_equal(series, [[3.0, 6.0, 12.0, 24.0]])


@pytest.mark.parametrize(
    ("points", "results", "count"),
    [
        (np.zeros((1, 8)), np.zeros((1, 8)), 8),
        (np.zeros((2, 8)), np.zeros((1, 4)), 8),
        (np.zeros((2, 8), dtype=np.float32), np.zeros((1, 8)), 8),
        (np.zeros((8, 2)).T, np.zeros((1, 8)), 8),
        (np.zeros((2, 8)), np.zeros((1, 8)), 6),
    ],
)
def test_arrays_that_do_not_fit_are_refused(points: np.ndarray, results: np.ndarray, count: int) -> None:
    kernel = CompiledFunction(casadi.Function("f", [A, B], [A + B]), 4)
    with pytest.raises(ValueError, match="must be"):
        kernel(points, results, count)
