"""The table of the observer's claims: NEES, bands and correlations of errors drawn at random."""

import numpy as np

from foreride.controller.observer.filter_layout import filter_layout
from foreride.scenarios.simulation.observer_claims import Claims, state_groups
from foreride.scenarios.tables.observer import error_table, innovation_table, normalised
from foreride.vehicle.load import load_vehicle

CAR = load_vehicle("half")


def drawn(seed: int, scale: float = 1.0, echo: float = 0.0) -> Claims:
    """Claims of unit variances; errors are `scale` as large, innovations repeat a share of the last one."""
    rng, size = np.random.default_rng(seed), filter_layout(CAR).size
    innovations = rng.standard_normal((400, 3))
    innovations[1:] += echo * innovations[:-1]
    errors = scale * rng.standard_normal((400, size))
    return Claims(CAR, errors, np.tile(np.eye(size), (400, 1, 1)), innovations)


def row(table: list[str], name: str) -> list[str]:
    return next(line for line in table if line.startswith(f"| {name}")).strip("| ").split(" | ")


def test_true_claims_have_a_nees_of_one_and_false_ones_their_ratio() -> None:
    for scale, share in ((1.0, 0.95), (3.0, 0.1)):
        cells = row(error_table([drawn(seed, scale) for seed in range(3)]), "wheel velocities")
        assert abs(float(cells[1]) / scale**2 - 1.0) < 0.1
        assert abs(float(cells[3].rstrip("%")) / 100.0 - share) < 0.25
        assert float(cells[4]) == np.round(scale, 0) or abs(float(cells[4]) / scale - 1.0) < 0.1
        assert float(cells[5]) == 1.0


def test_the_band_is_that_of_independent_drives() -> None:
    assert row(error_table([drawn(seed) for seed in range(10)]), "wheel velocities")[2] == "0.48 - 1.71"


def test_innovations_that_repeat_are_told_by_their_correlation() -> None:
    for echo, expected in ((0.0, 0.0), (1.0, 0.5)):
        cells = row(innovation_table([drawn(seed, echo=echo) for seed in range(3)]), "suspension travel")
        assert abs(float(cells[3]) - expected) < 0.08
        assert abs(float(cells[1]) - (1.0 + echo**2)) < 0.15


def test_correlated_errors_are_normalised_by_their_covariance() -> None:
    covariance = np.array([[[2.0, 1.0], [1.0, 1.0]]])
    np.testing.assert_allclose(normalised(np.array([[2.0, 1.0]]), covariance), [1.0])


def test_every_group_is_one_of_the_states() -> None:
    assert {group.shape[1] for group in state_groups(CAR).values()} == {filter_layout(CAR).size}
