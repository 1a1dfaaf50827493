"""Tests of what no road is, and of what few roads are."""

import numpy as np
import pytest

from foreride.files.errors import InputError
from foreride.road.io.plausibility import doubts
from foreride.road.io.surface_file import MeasuredSurface, surface

X = 0.1 * np.arange(601)
FLAT, WAVE = np.zeros(601), 0.01 * np.sin(2 * np.pi * X / 5)
ONE_LINE = np.array([0.0])


def loaded(z: np.ndarray, x: np.ndarray = X, **changes: float) -> MeasuredSurface:
    return surface(x, ONE_LINE, z[None], "road.csv")._replace(**changes)


@pytest.mark.parametrize("mark", [-9.999, -999.0, 9999.0])
def test_a_mark_for_a_missing_value_is_named(mark: float) -> None:
    z = WAVE.copy()
    z[300] = mark
    with pytest.raises(InputError, match=rf"height {mark:g} m at x = 30 m stands alone .*missing value"):
        loaded(z)


@pytest.mark.parametrize("factor", [100.0, 1000.0, 1e4])
def test_heights_in_another_unit_are_refused(factor: float) -> None:
    with pytest.raises(InputError, match=r"within a metre at x = .*allowed are 1 m; in (mm|cm) it would be"):
        loaded(factor * WAVE)


def test_what_roads_have_is_neither_refused_nor_doubted() -> None:
    kerb, grade = np.where(X > 30, 0.2, 0.0), 0.3 * X
    pothole = np.where(np.abs(X - 30) < 0.5, -0.25, 0.0)
    for z in (FLAT, WAVE, grade + WAVE, kerb, pothole):
        assert list(doubts(loaded(z))) == []


@pytest.mark.parametrize(
    ("road", "message"),
    [
        (loaded(WAVE[::50], X[::50]), r"stations every 5 m lack the waves shorter than 10 m"),
        (loaded(WAVE[:31], X[:31]), r"is 3 m long, too short for an IRI; .*--speed KMH"),
        (loaded(np.where(X > 30, 0.5, 0.0)), r"change by 0.5 m within a metre at x = 29.1 m|at x = 30 m"),
        (loaded(np.where(np.arange(601) == 300, 0.2, 0.0)), r"height at x = 30 m stands alone, 0.2 m off"),
        (loaded(8 * WAVE), r"has an IRI of \d+ m/km"),
        (loaded(WAVE, filled_m=0.6), r"0.6 m of it had missing heights"),
    ],
)
def test_what_few_roads_have_is_said(road: MeasuredSurface, message: str) -> None:
    import re

    assert any(re.search(message, line) for line in doubts(road)), list(doubts(road))


def test_wheels_beside_the_road_are_said() -> None:
    narrow = surface(X, np.array([-0.3, 0.3]), np.array([WAVE, WAVE]), "narrow.crg")
    assert list(doubts(narrow, (0.3, -0.3))) == []
    (line,) = doubts(narrow, (0.75, -0.75))
    assert line.startswith("covers y = -0.3 ... 0.3 m; the wheels at y = -0.75 and 0.75 m run beside it")
    assert list(doubts(loaded(WAVE), (0.75,))) == []
