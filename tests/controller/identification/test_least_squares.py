"""Bank of recursive least-squares models against the truth and their own standard deviations."""

import numpy as np

from foreride.controller.identification.least_squares import LeastSquaresBank

TRUTH = np.array([0.8, 0.6])


def filled(seed: int, samples: int, memory: float = 1e9, sigma: float = 0.3) -> LeastSquaresBank:
    """Bank of a true model and one with foreign regressors, with white noise on the output."""
    rng, bank = np.random.default_rng(seed), LeastSquaresBank(2, np.ones(2), 0.3, memory, 1.0, 1e-3)
    for _ in range(samples):
        own, foreign = rng.normal(size=(2, 2, 2))
        bank.add((own @ TRUTH + sigma * rng.normal(size=2))[None], np.stack([own, foreign])[None])
    return bank


def test_without_data_it_gives_the_prior() -> None:
    fit = LeastSquaresBank(3, np.ones(2), 0.3, 100.0, 1.0, 1e-3).fit()
    np.testing.assert_allclose(fit.parameters, 1.0)
    np.testing.assert_allclose(fit.covariance, np.tile(0.09 * np.eye(2), (3, 1, 1)))


def test_it_converges_to_the_truth_and_the_true_model_explains_best() -> None:
    fit = filled(0, 2000).fit()
    np.testing.assert_allclose(fit.parameters[0], TRUTH, atol=0.02)
    assert np.sqrt(fit.residual[0]) < 1.05 * 0.3
    assert fit.residual[1] > 5.0 * fit.residual[0]


def test_its_standard_deviations_are_honest() -> None:
    """Over 200 data sets the normalised squared errors have the mean of a chi-square of two degrees."""
    squares = []
    for seed in range(200):
        fit = filled(seed, 40).fit()
        error = fit.parameters[0] - TRUTH
        squares.append(error @ np.linalg.solve(fit.covariance[0], error))
    assert 1.7 < np.mean(squares) < 2.4


def test_data_fade_and_the_prior_stays() -> None:
    bank = filled(1, 500, memory=50.0)
    before = bank.fit().parameters[0]
    bank.add(np.zeros((1000, 2)), np.zeros((1000, 2, 2, 2)))
    np.testing.assert_allclose(before, TRUTH, atol=0.1)
    np.testing.assert_allclose(bank.fit().parameters[0], 1.0, atol=0.02)


def test_mean_squares_are_those_of_a_single_sample_too() -> None:
    bank = LeastSquaresBank(1, np.ones(2), 0.3, 1e9, 4.0, 1e-3)
    bank.add(np.array([[3.0]]), np.zeros((1, 1, 1, 2)))
    fit = bank.fit()
    np.testing.assert_allclose([fit.output, fit.residual[0], fit.independent], [9.0, 9.0, 0.25])
