"""Height-profile likelihood: shape information of measured profiles."""

import numpy as np
import pytest

from foreride.preview.obstacle_classes import BUMP, HUMP, POTHOLE, TABLE, ObstacleTemplate
from foreride.preview.settings import Settings
from foreride.preview.tracking.gauss_newton import Fit, fit, start_state
from foreride.preview.tracking.height_likelihood import (
    HeightRows,
    HeightSamples,
    NearEdge,
    equations,
    visible_height,
)
from foreride.preview.tracking.mounting_filter import Calibration
from foreride.preview.tracking.obstacle_templates import ramp_share, unit_profile

SETTINGS = Settings()


def measured(
    kind: ObstacleTemplate, start: float, length: float, height: float, noise: float = 0.003
) -> HeightSamples:
    """Six frames, ever nearer, of an exact shape."""
    rng = np.random.default_rng(4)
    samples = HeightSamples(0.02)
    x = np.arange(start - 1.5, start + length + 1.5, 0.05)
    for slant in np.linspace(6.0, 3.0, 6):
        rows = HeightRows(
            x, np.zeros(len(x)), np.full(len(x), 0.005), np.full(len(x), 0.02), np.full(len(x), slant)
        )
        z = visible_height(kind, rows, start, length, height) + noise * rng.standard_normal(len(x))
        samples.add(rows._replace(z_m=z))
    return samples


def fitted(kind: ObstacleTemplate, elevation: HeightSamples, near: float) -> Fit:
    prior = Calibration(SETTINGS, 457.0).prior(kind.cls)
    state = start_state(near, prior, kind.length_m, kind.height_m)
    return fit(kind, [], state, prior, [], SETTINGS, 12, elevation)


@pytest.mark.parametrize(
    ("kind", "length", "height"), [(BUMP, 0.5, 0.08), (TABLE, 3.6, 0.1), (POTHOLE, 0.9, 0.1)]
)
@pytest.mark.parametrize("slant", [2.5, 6.0])
def test_lines_of_sight_end_where_they_meet_the_shape_first(
    kind: ObstacleTemplate, length: float, height: float, slant: float
) -> None:
    """Against marching along each line in steps of a millimetre."""
    crossing = np.arange(9.5, 10.0 + length + 1.0, 0.037)
    nothing = np.zeros(len(crossing))
    rows = HeightRows(crossing, nothing, nothing + 0.01, nothing, nothing + slant)
    found = visible_height(kind, rows, 10.0, length, height)
    x = np.arange(9.0, 12.0 + length, 0.001)
    ground = height * unit_profile(kind, np.clip((x - 10.0) / length, 0.0, 1.0), length)
    for meets, z in zip(crossing, found, strict=True):
        line = (meets - x) / slant
        met = int(np.argmax(line <= ground + 1e-12))
        assert z == pytest.approx(ground[met], abs=0.05 * height + 0.001)


def test_old_frames_are_forgotten_and_variances_inflated() -> None:
    found = measured(BUMP, 30.0, 0.5, 0.06)
    given = found.frames[-1]
    for _ in range(9):
        found.add(given, NearEdge(30.0, 0.02, 0.0))
    assert len(found.frames) == len(found.edges) == 8
    assert all(np.all(rows.sigma_m > given.sigma_m) for rows in found.frames)


@pytest.mark.parametrize(
    ("kind", "length", "height"),
    [(BUMP, 0.5, 0.06), (HUMP, 3.7, 0.11), (TABLE, 3.3, 0.075), (POTHOLE, 0.7, 0.05)],
)
def test_a_fit_finds_edge_length_and_height_of_a_profile(
    kind: ObstacleTemplate, length: float, height: float
) -> None:
    found = fitted(kind, measured(kind, 30.0, length, height), 30.12)
    start, _, _, fitted_length, fitted_height, _ = found.state
    assert start == pytest.approx(30.0, abs=0.04)
    assert fitted_length == pytest.approx(length, abs=0.08 + 0.03 * length)
    assert fitted_height == pytest.approx(height, rel=0.08)
    assert found.sigma_m == pytest.approx(0.021, abs=0.008)  # not less than the common shift of all positions


@pytest.mark.parametrize(("true", "other"), [(HUMP, TABLE), (TABLE, HUMP), (BUMP, HUMP), (HUMP, BUMP)])
def test_the_kind_that_was_measured_costs_least(true: ObstacleTemplate, other: ObstacleTemplate) -> None:
    elevation = measured(true, 30.0, true.length_m, true.height_m)
    assert fitted(true, elevation, 30.0).cost < fitted(other, elevation, 30.0).cost - 3.0


def shifted(elevation: HeightSamples, away) -> HeightSamples:  # type: ignore[no-untyped-def]
    """The same samples with `away(frame number, x)` added to their heights."""
    moved = HeightSamples(elevation.shift_sigma_m)
    for number, rows in enumerate(elevation.frames):
        moved.frames.append(rows._replace(z_m=rows.z_m + away(number, rows.x_m - 30.0)))
    return moved


@pytest.mark.parametrize(
    "away",
    [
        lambda number, x: 0.008 + 0.003 * x,
        lambda number, x: (-1) ** number * (0.006 + 0.004 * x),
    ],
    ids=["ground at the object", "plane of each frame"],
)
def test_ground_that_lies_higher_or_slopes_is_not_taken_for_the_object(away) -> None:  # type: ignore[no-untyped-def]
    level = measured(BUMP, 30.0, 0.45, 0.075)
    tilted = shifted(level, away)
    state = np.array([30.0, 0.0, 0.0, 0.45, 0.075, 0.0])
    information, before, cost = equations(BUMP, level, state)
    _, after, tilted_cost = equations(BUMP, tilted, state)
    step = np.abs(after - before)[4] / information[4, 4]
    assert step < 0.002
    assert tilted_cost < cost + 2.0


def test_what_is_marginalised_is_what_the_joint_normal_equations_leave_out() -> None:
    """Against least squares over the state and all nuisances together, their priors as extra rows."""
    elevation = measured(TABLE, 30.0, 3.5, 0.09)
    elevation.edges.append(NearEdge(30.02, 0.03, 12.0))
    state = np.array([30.03, 0.0, 0.0, 3.4, 0.085, 0.001])
    information, gradient, cost = equations(TABLE, elevation, state)
    frames = len(elevation.frames)
    rows = HeightRows(*(np.concatenate(parts) for parts in zip(*elevation.frames, strict=True)))

    def model(values: np.ndarray) -> np.ndarray:
        """Residuals, each over its sigma: samples, edge, priors; values: state, then nuisances."""
        start, low, length, height = values[[0, 5, 3, 4]]
        ground, slope, shift, ramp = values[6:10]
        own = values[10:].reshape(frames, 2)
        behind = rows.x_m - state[0] - 0.5 * state[3]
        z = (
            visible_height(
                TABLE, rows, start + shift, length, height, float(ramp_share(TABLE, state[3])) + ramp
            )
            + ground
            + slope * behind
        )
        each = np.repeat(np.arange(frames), len(elevation.frames[0].x_m))
        z += own[each, 0] + own[each, 1] * behind
        edge = 30.02 + 12.0 * low - start - shift
        priors = values[6:] / np.concatenate([[0.015, 0.005, 0.02, 0.06], np.tile([0.008, 0.008], frames)])
        return np.concatenate([(rows.z_m - z) / rows.sigma_m, [edge / 0.03], priors])

    at = np.concatenate([state, np.zeros(4 + 2 * frames)])
    steps = np.full(len(at), 1e-3)
    steps[[0, 3, 4, 8, 9]] = 0.01, 0.01, 0.002, 0.01, 0.01  # as far as the code's differences reach
    residual = model(at)
    jacobian = np.stack([(model(at + h) - model(at - h)) / (2 * h.max()) for h in np.diag(steps)], axis=1)
    robust = 1.0 / np.sqrt(1.0 + (residual / 3.0) ** 2)
    robust[-(len(at) - 6) :] = 1.0
    jacobian, residual = jacobian * robust[:, None], residual * robust
    joint = jacobian.T @ jacobian
    right = -jacobian.T @ residual
    used, aside = np.array([0, 3, 4, 5]), np.arange(6, len(at))
    cross = joint[np.ix_(aside, used)]
    solved = np.linalg.solve(joint[np.ix_(aside, aside)], np.column_stack([cross, right[aside]]))
    np.testing.assert_allclose(
        information[np.ix_(used, used)], joint[np.ix_(used, used)] - cross.T @ solved[:, :-1], rtol=1e-4
    )
    np.testing.assert_allclose(gradient[used], right[used] - cross.T @ solved[:, -1], rtol=1e-4)
    assert cost == pytest.approx(0.5 * (residual @ residual - right[aside] @ solved[:, -1]), rel=1e-4)


def test_ramps_of_another_length_do_not_move_the_edge() -> None:
    """Ramps of 0.16 instead of 0.225 of the length."""
    found = measured(TABLE, 30.0, 4.0, 0.1)
    longer = HeightSamples(0.02)
    for rows in found.frames:
        z = visible_height(TABLE, rows, 30.0, 4.0, 0.1, 0.16)
        longer.add(rows._replace(z_m=z), NearEdge(30.0, 0.05, 0.0))
    assert fitted(TABLE, longer, 30.1).state[0] == pytest.approx(30.0, abs=0.05)


def test_positions_are_those_of_a_stereo_pair_unless_told_otherwise() -> None:
    assert HeightSamples(0.03).absolute


@pytest.mark.parametrize("from_middle", [0.0, 0.7, -0.6])
@pytest.mark.parametrize("frames", [1, 2])
def test_a_sample_of_a_flat_top_is_as_certain_as_itself_and_the_ground_of_frame_and_object(
    from_middle: float, frames: int
) -> None:
    """8 mm and 0.8 % of each frame's plane, 15 mm and 0.5 % of the ground at the object; means of frames."""
    state = np.array([30.0, 0.0, 0.0, 4.0, 0.1, 0.0])
    x = np.array([32.0 + from_middle])
    zero, sigma = np.zeros(1), 0.006
    samples = HeightSamples(0.02)
    for _ in range(frames):
        samples.frames.append(HeightRows(x, zero + 0.1, zero + sigma, zero, zero))
    information, gradient, _ = equations(TABLE, samples, state)
    own = sigma**2 + 0.008**2 + (0.008 * from_middle) ** 2
    variance = own / frames + 0.015**2 + (0.005 * from_middle) ** 2
    assert information[4, 4] == pytest.approx(1.0 / variance, rel=1e-6)
    np.testing.assert_allclose(gradient, 0.0, atol=1e-9)
    np.testing.assert_allclose(np.delete(information[4], 4), 0.0, atol=1e-6 * information[4, 4])


def test_a_shape_that_is_sampled_at_its_crest_costs_the_doubt_about_the_smear() -> None:
    """Logarithm of three times the mean's distance from the middle, with the own sigma, over that."""
    x, one = np.array([30.25]), np.ones(1)
    rows = HeightRows(x, 0.0 * one, 0.005 * one, 0.3 * one, 1e-9 * one)
    mean = visible_height(BUMP, rows, 30.0, 0.5, 0.08)
    crest = visible_height(BUMP, rows._replace(smear_m=0.0 * one), 30.0, 0.5, 0.08)
    samples = HeightSamples(0.02)
    samples.frames.append(rows._replace(z_m=mean))
    cost = equations(BUMP, samples, np.array([30.0, 0.0, 0.0, 0.5, 0.08, 0.0]))[2]
    assert cost == pytest.approx(np.log(np.hypot(0.005, 3.0 * (crest - mean)[0]) / 0.005))
