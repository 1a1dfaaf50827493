"""Validation of whole drives against published quarter cars, in scenarios of the library."""

from functools import cache

import numpy as np
from numpy.typing import NDArray
from scipy import signal

from foreride.road.roughness.iri import rectified_slope
from foreride.scenarios.cases import Case
from foreride.scenarios.definition.loading import load
from foreride.scenarios.simulation.simulate import Run, simulate
from foreride.scenarios.validation.check import Check, Checks

Array = NDArray[np.float64]
MATHWORKS = {"mb": 300.0, "mw": 60.0, "bs": 1000.0, "ks": 16000.0, "kt": 190000.0}
CTMS = {"M1": 2500.0, "M2": 320.0, "K1": 80000.0, "K2": 500000.0, "b1": 350.0, "b2": 15020.0}


@cache
def _drive(name: str) -> Run:
    return simulate(Case(load(name), "passive", "none", 0))


def _deviation(found: Array, expected: Array) -> float:
    return float(np.max(np.abs(found - expected)) / np.max(np.abs(expected)))


def _mathworks() -> Check:
    """State space of the example (xb, its rate, xw, its rate) over its road of 0.025 (1 - cos 8 pi t)."""
    mb, mw, bs, ks, kt = MATHWORKS.values()
    a = [[0, 1, 0, 0], [-ks / mb, -bs / mb, ks / mb, bs / mb],
         [0, 0, 0, 1], [ks / mw, bs / mw, (-ks - kt) / mw, -bs / mw]]  # fmt: skip
    c = [[1, 0, 0, 0], [1, 0, -1, 0], a[1]]
    signals = _drive("published_mathworks").signals
    time = signals["time_s"]
    t = time - 0.9  # at 20 m/s the bump at 20 m begins 18 m behind the start
    road = np.where((t > 0) & (t < 0.25), 0.025 * (1 - np.cos(8 * np.pi * t)), 0.0)
    system = signal.StateSpace(a, [[0], [0], [0], [kt / mw]], c, np.zeros((3, 1)))
    travel, deflection, acc = signal.lsim(system, road, time)[1].T
    deviation = max(
        _deviation(signals["heave_m"], travel),
        _deviation(signals["rattle_m_0"], deflection),
        _deviation(signals["seat_acc_0"], acc),
    )
    reference = "MathWorks, Robust Control of Active Suspension; scipy lsim"
    return Check("published_mathworks: body travel, stroke, acceleration", reference, deviation, 5e-4)


def _ctms() -> Check:
    """Transfer function of the tutorial from the road W to the stroke X1 - X2, with its determinant."""
    m1, m2, k1, k2, b1, b2 = CTMS.values()
    first, second, coupling = np.array([m1, b1, k1]), np.array([m2, b1 + b2, k1 + k2]), np.array([b1, k1])
    determinant: np.ndarray = np.polysub(np.polymul(first, second), np.polymul(coupling, coupling))
    stroke = signal.TransferFunction([-m1 * b2, -m1 * k2, 0, 0], determinant)
    signals = _drive("published_ctms").signals
    time = signals["time_s"]
    road = 0.02 * np.clip((time - 1.8) / 0.01, 0.0, 1.0)  # at 10 m/s the step at 20 m begins 18 m on
    expected = signal.lsim(stroke, road, time)[1]
    reference = "CTMS, University of Michigan, G2(s); scipy lsim"
    deviation = _deviation(signals["rattle_m_0"], expected)
    return Check("published_ctms: stroke after a step", reference, deviation, 1e-3)


def _golden_car() -> Check:
    """Mean |stroke rate| / speed of the plant against the index of the profile that it drove over."""
    run = _drive("golden_car_80")
    scenario, signals = run.case.scenario, run.signals
    step, begin_m = 0.05, 30.0
    x = np.arange(0.0, scenario.road.length_m, step)
    slopes = rectified_slope(scenario.road.height(x, run.track_y_m), step)
    places = x[: len(slopes)] + step * 2.5  # each slope lies in the middle of its six heights
    driven = signals["x_m"] > begin_m
    end_m = float(signals["x_m"][-1])
    expected = float(np.mean(slopes[(places > begin_m) & (places < end_m)]))
    found = float(np.mean(np.abs(signals["rattle_velocity_0"][driven]))) / scenario.speed_m_s
    name = f"golden_car_80: IRI of the drive, {1000 * expected:.2f} m/km"
    return Check(name, "Sayers 1995 on the profile", abs(found / expected - 1), 5e-3)


CHECKS: Checks = (_mathworks, _ctms, _golden_car)
