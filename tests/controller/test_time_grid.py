import numpy as np

from controller.time_grid import LONGEST_STEP_S, TimeGrid, uniform


def test_intervals_are_cut_into_equal_short_steps() -> None:
    grid = TimeGrid((0.004, 0.005, 0.012))
    np.testing.assert_allclose(grid.step_s, [0.004, 0.005, 0.004, 0.004, 0.004])
    np.testing.assert_array_equal(grid.interval, [0, 1, 2, 2, 2])
    np.testing.assert_allclose(grid.nodes_s, [0.0, 0.004, 0.009, 0.013, 0.017, 0.021])
    np.testing.assert_allclose(grid.starts_s, [0.0, 0.004, 0.009])
    assert grid.step_s.max() <= LONGEST_STEP_S


def test_a_uniform_grid_has_at_least_two_intervals() -> None:
    assert uniform(0.2, 0.01).intervals_s == (0.01,) * 20
    assert uniform(0.001, 0.01).intervals_s == (0.01,) * 2
