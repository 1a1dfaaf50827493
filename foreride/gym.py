"""Gymnasium environments; importing this module registers `foreride/Damper-v0` for `gymnasium.make`."""

from gymnasium.envs.registration import register

from foreride.scenarios.gym.damper_env import DamperEnv
from foreride.scenarios.gym.observation import ObservationLayout

__all__ = ["DamperEnv", "ObservationLayout"]

register("foreride/Damper-v0", entry_point="foreride.scenarios.gym.damper_env:DamperEnv")
