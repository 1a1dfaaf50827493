"""What a measured profile says of an object's shape."""

import numpy as np
import pytest

from preview.calibration import Calibration
from preview.elevation import Elevation, Rows, equations, seen
from preview.fit import Fit, fit, start_state
from preview.settings import Settings
from preview.shape import BUMP, HUMP, POTHOLE, TABLE, Kind, relief

SETTINGS = Settings()


def measured(kind: Kind, start: float, length: float, height: float, noise: float = 0.003) -> Elevation:
    """Six frames, ever nearer, of an exact shape."""
    rng = np.random.default_rng(4)
    found = Elevation(0.02)
    x = np.arange(start - 1.5, start + length + 1.5, 0.05)
    for slant in np.linspace(6.0, 3.0, 6):
        rows = Rows(
            x, np.zeros(len(x)), np.full(len(x), 0.005), np.full(len(x), 0.02), np.full(len(x), slant)
        )
        z = seen(kind, rows, start, length, height) + noise * rng.standard_normal(len(x))
        found.frames.append(rows._replace(z_m=z))
    return found


def fitted(kind: Kind, elevation: Elevation, near: float) -> Fit:
    prior = Calibration(SETTINGS, 457.0).prior(kind.cls)
    state = start_state(near, prior, kind.length_m, kind.height_m)
    return fit(kind, [], state, prior, [], SETTINGS, 12, elevation)


@pytest.mark.parametrize(
    ("kind", "length", "height"), [(BUMP, 0.5, 0.08), (TABLE, 3.6, 0.1), (POTHOLE, 0.9, 0.1)]
)
@pytest.mark.parametrize("slant", [2.5, 6.0])
def test_lines_of_sight_end_where_they_meet_the_shape_first(
    kind: Kind, length: float, height: float, slant: float
) -> None:
    """Against marching along each line in steps of a millimetre."""
    crossing = np.arange(9.5, 10.0 + length + 1.0, 0.037)
    nothing = np.zeros(len(crossing))
    rows = Rows(crossing, nothing, nothing + 0.01, nothing, nothing + slant)
    found = seen(kind, rows, 10.0, length, height)
    x = np.arange(9.0, 12.0 + length, 0.001)
    ground = height * relief(kind, np.clip((x - 10.0) / length, 0.0, 1.0), length)
    for meets, z in zip(crossing, found, strict=True):
        line = (meets - x) / slant
        met = int(np.argmax(line <= ground + 1e-12))
        assert z == pytest.approx(ground[met], abs=0.05 * height + 0.001)


def test_old_frames_are_forgotten_and_variances_inflated() -> None:
    found = measured(BUMP, 30.0, 0.5, 0.06)
    for _ in range(9):
        found.frames.append(found.frames[-1])
    rows = found.rows()
    assert len(rows.x_m) == 8 * len(found.frames[0].x_m)
    assert np.all(rows.sigma_m > 0.005)


@pytest.mark.parametrize(
    ("kind", "length", "height"),
    [(BUMP, 0.5, 0.06), (HUMP, 3.7, 0.11), (TABLE, 3.3, 0.075), (POTHOLE, 0.7, 0.05)],
)
def test_a_fit_finds_edge_length_and_height_of_a_profile(kind: Kind, length: float, height: float) -> None:
    found = fitted(kind, measured(kind, 30.0, length, height), 30.12)
    start, _, _, fitted_length, fitted_height, _ = found.state
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
    level = elevation.rows()
    state = np.array([30.0, 0.0, 0.0, 0.45, 0.075])
    _, before, cost = equations(BUMP, level, 0.02, state)
    tilted = level._replace(z_m=level.z_m + 0.008 + 0.003 * (level.x_m - 30.0))
    _, after, tilted_cost = equations(BUMP, tilted, 0.02, state)
    step = np.abs(after - before)[4] / equations(BUMP, level, 0.02, state)[0][4, 4]
    assert step < 0.002
    assert tilted_cost < cost + 2.0
