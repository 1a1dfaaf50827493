import numpy as np

from foreride.controller.mpc.time_grid import TimeGrid, graded_grid


def test_intervals_are_cut_into_equal_short_steps() -> None:
    grid = TimeGrid((0.004, 0.005, 0.012))
    np.testing.assert_allclose(grid.step_s, [0.004, 0.005, 0.004, 0.004, 0.004])
    np.testing.assert_array_equal(grid.interval, [0, 1, 2, 2, 2])
    np.testing.assert_allclose(grid.nodes_s, [0.0, 0.004, 0.009, 0.013, 0.017, 0.021])
    assert len(TimeGrid((0.0051,)).step_s) == 2


def test_a_growing_grid_doubles_its_intervals_after_the_fine_part_and_where_the_time_has_quadrupled() -> None:
    assert graded_grid(0.24, 0.03, 0.01).intervals_s == (0.01,) * 3 + (0.02,) * 4 + (0.04,) * 3
    assert graded_grid(0.2, 0.2, 0.01).intervals_s == (0.01,) * 20
    assert graded_grid(0.1, 0.04, 0.01).intervals_s == (0.01,) * 4 + (0.02,) * 3
    assert graded_grid(0.001, 0.1, 0.01).intervals_s == (0.01,) * 2


def test_shifting_by_an_interval_takes_the_next_entry() -> None:
    plan = np.array([[1.0], [2.0], [5.0]])
    np.testing.assert_allclose(TimeGrid((0.01,) * 3).shift(0.01) @ plan, [[2.0], [5.0], [5.0]])


def test_shifting_long_intervals_takes_the_mean_of_what_they_then_stand_for() -> None:
    plan = np.array([[1.0], [2.0], [5.0], [9.0]])
    moved = TimeGrid((0.01, 0.01, 0.02, 0.02)).shift(0.01) @ plan
    np.testing.assert_allclose(moved, [[2.0], [5.0], [7.0], [9.0]])
