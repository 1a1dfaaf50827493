"""Gymnasium environment: its contract, its return against J, repeated seeds and invalid input."""

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import foreride.gym
from foreride.files.errors import InputError
from foreride.scenarios.gym.damper_env import DamperEnv

SHORT = {"start_m": 34.0, "road.length_m": 54.0}
QUARTER = SHORT | {"vehicle.model": "quarter"}


def make(**changes: object) -> DamperEnv:
    return DamperEnv(**({"scenario": "bump_8x40_30", "overrides": SHORT} | changes))


def passive_action(env: DamperEnv) -> np.ndarray:
    """Action whose command is the passive damping of each wheel."""
    passive = np.array([c.damping_passive_ns_m for c in env.scenarios[0].vehicle.parameters.corners])
    low, high = env._low, env._high
    return (2.0 * (passive - low) / (high - low) - 1.0).astype(np.float64)


def episode(env: DamperEnv, action: np.ndarray, seed: int = 1) -> tuple[list[np.ndarray], list[float], dict]:
    seen, _ = env.reset(seed=seed)
    observations, rewards, truncated, info = [seen], [], False, {}
    while not truncated:
        seen, reward, _, truncated, info = env.step(action)
        observations.append(seen)
        rewards.append(reward)
    return observations, rewards, info


def test_environment_keeps_gymnasiums_contract() -> None:
    env = gymnasium.make("foreride/Damper-v0", scenario="bump_8x40_30", overrides=SHORT)
    check_env(env.unwrapped, skip_render_check=True)


@pytest.mark.parametrize("changes", [QUARTER, SHORT], ids=["quarter", "half"])
def test_return_is_minus_the_objective(changes: dict) -> None:
    env = make(overrides=changes)
    _, rewards, info = episode(env, passive_action(env))
    assert sum(rewards) == pytest.approx(-info["metrics"]["objective"], rel=1e-9)


def test_passive_action_drives_as_the_passive_car() -> None:
    env = make()
    _, _, info = episode(env, passive_action(env), seed=1)
    driven = foreride.run("bump_8x40_30", "passive", "none", seed=1, overrides=SHORT)
    assert info["metrics"]["objective"] == pytest.approx(driven.metrics["objective"], rel=1e-9)


def test_same_seed_gives_the_same_episode_and_another_one_other_noise() -> None:
    action = np.zeros(2)
    first, again, other = (episode(make(perception="boxes"), action, seed) for seed in (3, 3, 4))
    np.testing.assert_array_equal(first[0], again[0])
    assert first[1] == again[1]
    assert not np.array_equal(first[0], other[0])


def test_episode_has_one_step_per_control_period() -> None:
    env = make(overrides=SHORT | {"control.rate_hz": 50})
    observations, rewards, _ = episode(env, np.zeros(2))
    assert len(rewards) == -(-env.scenarios[0].ticks // 20)
    assert observations[0].shape == (len(env.layout.names),)


def test_preview_shows_the_bump_before_the_wheel() -> None:
    env = make()
    observations, _, _ = episode(env, np.zeros(2))
    at = env.layout.names.index("preview_height_m_0_0.5s")
    under = env.layout.names.index("road_height_m_0")
    history = np.array(observations)
    assert history[:, at].max() > 0.05
    assert np.argmax(history[:, at] > 0.02) < np.argmax(history[:, under] > 0.02)


def test_vectorised_environments_differ_by_their_seed() -> None:
    envs = gymnasium.make_vec(
        "foreride/Damper-v0", num_envs=2, vectorization_mode="sync", scenario="bump_8x40_30", overrides=SHORT
    )
    seen, info = envs.reset(seed=5)
    assert seen.shape[0] == 2
    assert info["seed"].tolist() == [5, 6]
    envs.close()


def test_several_scenarios_are_all_drawn() -> None:
    env = make(scenario=["bump_8x40_30", "hump_flat_30"])
    assert {env.reset()[1]["scenario"] for _ in range(12)} == {"bump_8x40_30", "hump_flat_30"}


@pytest.mark.parametrize("action", [np.zeros(3), np.full(2, np.nan)])
def test_wrong_action_is_refused(action: np.ndarray) -> None:
    env = make()
    env.reset(seed=0)
    with pytest.raises(InputError, match="action must be 2 finite numbers"):
        env.step(action)


def test_step_before_reset_is_refused() -> None:
    with pytest.raises(InputError, match="call reset first"):
        make().step(np.zeros(2))


def test_unknown_scenario_and_perception_are_refused() -> None:
    with pytest.raises(InputError, match="nowhere"):
        make(scenario="nowhere")
    with pytest.raises(InputError, match="perception"):
        make(perception="smell")
