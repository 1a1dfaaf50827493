"""What a measured profile says of an object's shape."""

import numpy as np
import pytest

from preview.calibration import Calibration
from preview.elevation import STEP_M, Elevation, Rows, equations
from preview.fit import Fit, fit
from preview.settings import Settings
from preview.shape import BUMP, HUMP, POTHOLE, TABLE, Kind, relief

SETTINGS = Settings()


def measured(kind: Kind, start: float, length: float, height: float, noise: float = 0.003) -> Elevation:
    rng = np.random.default_rng(4)
    found = Elevation(start - 2.0, 0.02)
    x = np.arange(start - 1.5, start + length + 1.5, 0.03)
    share = np.clip((x - start) / length, 0.0, 1.0)
    for _ in range(6):
        z = height * relief(kind, share, length) + noise * rng.standard_normal(len(x))
        found.add(Rows(x, z, np.full(len(x), 0.005), np.full(len(x), 0.02), np.full(len(x), 4.0)))
    return found


def fitted(kind: Kind, elevation: Elevation, near: float) -> Fit:
    prior = Calibration(SETTINGS).prior()
    state = np.array([near, *prior.mean, kind.length_m, kind.height_m])
    return fit(kind, [], state, prior, [], SETTINGS, 12, elevation)


def test_bins_hold_the_mean_of_what_fell_into_them() -> None:
    found = Elevation(10.0, 0.02)
    samples = np.array([0.01, 0.03]), np.array([0.01, 0.01]), np.zeros(2), np.zeros(2)
    found.add(Rows(np.array([10.0, 10.0]), *samples))
    rows = found.rows(correlation=1.0)
    assert rows.x_m.tolist() == [10.0]
    assert rows.z_m[0] == pytest.approx(0.02)
    assert rows.sigma_m[0] == pytest.approx(np.hypot(0.01 / np.sqrt(2), 0.003))
    found.add(Rows(np.array([10.0 + 0.5 * STEP_M]), *(part[:1] for part in samples)))
    assert len(found.rows(1.0).x_m) == 2
    found.add(Rows(np.array([5.0, 900.0]), *samples))
    assert len(found.rows(1.0).x_m) == 2


@pytest.mark.parametrize(
    ("kind", "length", "height"),
    [(BUMP, 0.5, 0.06), (HUMP, 3.7, 0.11), (TABLE, 3.3, 0.075), (POTHOLE, 0.7, 0.05)],
)
def test_a_fit_finds_edge_length_and_height_of_a_profile(kind: Kind, length: float, height: float) -> None:
    found = fitted(kind, measured(kind, 30.0, length, height), 30.12)
    start, _, _, fitted_length, fitted_height = found.state
    assert start == pytest.approx(30.0, abs=0.04)
    assert fitted_length == pytest.approx(length, abs=0.08 + 0.03 * length)
    assert fitted_height == pytest.approx(height, rel=0.08)
    assert found.sigma_m == pytest.approx(0.021, abs=0.008)  # not less than what shifts all positions


@pytest.mark.parametrize(("true", "other"), [(HUMP, TABLE), (TABLE, HUMP), (BUMP, HUMP), (HUMP, BUMP)])
def test_the_kind_that_was_measured_costs_least(true: Kind, other: Kind) -> None:
    elevation = measured(true, 30.0, true.length_m, true.height_m)
    assert fitted(true, elevation, 30.0).cost < fitted(other, elevation, 30.0).cost - 3.0


def test_ground_that_lies_higher_or_slopes_is_not_taken_for_the_object() -> None:
    elevation = measured(BUMP, 30.0, 0.45, 0.075)
    level = elevation.rows(2.0)
    state = np.array([30.0, 0.0, 0.0, 0.45, 0.075])
    _, before, cost = equations(BUMP, level, 0.02, state)
    tilted = level._replace(z_m=level.z_m + 0.008 + 0.003 * (level.x_m - 30.0))
    _, after, tilted_cost = equations(BUMP, tilted, 0.02, state)
    step = np.abs(after - before)[4] / equations(BUMP, level, 0.02, state)[0][4, 4]
    assert step < 0.002
    assert tilted_cost < cost + 2.0
