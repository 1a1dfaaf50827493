"""Training of a damper policy by reinforcement learning, and the controller that drives with it.

python examples/train_policy.py --minutes 10            # extra rl; writes policy.npz beside it
foreride compare hump_watts_30 --controllers passive,skyhook,mpc_preview,examples/train_policy.py:Policy

The policy is a small network over the observation of `scenarios.gym`. It first imitates the predictive
controller; PPO then goes on from there. `Policy` evaluates it with NumPy alone.
"""

import argparse
import time
from pathlib import Path
from typing import Any

import numpy as np

from foreride.controller.command_limits import command_limits
from foreride.controller.interface import Estimate, Timing
from foreride.controller.registry import build
from foreride.preview.road_preview import RoadPreview
from foreride.scenarios.cases import Case
from foreride.scenarios.definition.loading import load
from foreride.scenarios.gym.observation import ObservationLayout
from foreride.scenarios.simulation.simulate import assembled
from foreride.vehicle.load import Car, control_model

POLICY = Path(__file__).with_name("policy.npz")
DRIVES = [
    *(("hump_flat_30", speed) for speed in (20.0, 30.0, 40.0)),
    *((name, speed) for name in ("bump_8x40_30", "pothole_60x8_40", "mixed_40") for speed in (30.0, 45.0)),
    *(("rough_b_80", speed) for speed in (50.0, 80.0)),
    *(("rough_c_60", speed) for speed in (40.0, 60.0)),
]
CAR = {"vehicle.model": "half"}
TEACHER = "mpc_preview"
DISCOUNT = 0.995  # a memory of one second at 200 steps per second


class Policy:
    """Controller: the trained network on the observation that it was trained with."""

    def __init__(self, vehicle: Car, timing: Timing):
        self._layout, (self._low, self._high) = ObservationLayout.of(vehicle), command_limits(vehicle)
        with np.load(POLICY) as stored:
            self._arrays = {name: stored[name] for name in stored.files}
        if len(self._arrays["mean"]) != len(self._layout.names):
            raise ValueError(f"{POLICY.name} was trained for another car")

    def reset(self) -> None:
        pass

    def step(self, estimate: Estimate, preview: RoadPreview | None) -> np.ndarray:
        arrays = self._arrays
        hidden = (self._layout.vector(estimate, preview) - arrays["mean"]) / arrays["sigma"]
        hidden = np.clip(hidden, -10.0, 10.0)
        for layer in range(2):
            hidden = np.tanh(arrays[f"weight_{layer}"] @ hidden + arrays[f"bias_{layer}"])
        action = np.clip(arrays["weight_2"] @ hidden + arrays["bias_2"], -1.0, 1.0)
        return self._low + 0.5 * (action + 1.0) * (self._high - self._low)


def cases() -> list[Case]:
    """Drives of the training."""
    return [Case(load(n, CAR | {"speed_kmh": v}), "passive", "oracle", i) for i, (n, v) in enumerate(DRIVES)]


def teacher_drives() -> tuple[np.ndarray, np.ndarray]:
    """Observations and actions of the teacher on every drive."""
    seen, done = [], []
    for case in cases():
        car, control = control_model(case.scenario.vehicle.parameters), case.scenario.control
        teacher = build(TEACHER, car, control.settings, control.timing)
        layout, (low, high) = ObservationLayout.of(car), command_limits(car)
        loop, _, perception = assembled(case, controller=teacher)
        decisions = loop.decisions(lambda ticks: None)
        decision = next(decisions, None)
        while decision is not None:
            command = teacher.step(decision.estimate, decision.preview)
            seen.append(layout.vector(decision.estimate, decision.preview))
            done.append(2.0 * (command - low) / (high - low) - 1.0)
            try:
                decision = decisions.send(command)
            except StopIteration:
                decision = None
        perception.close()
    return np.array(seen), np.array(done)


def environment() -> Any:
    """Environment of all drives."""
    from foreride.scenarios.gym.damper_env import DamperEnv

    return DamperEnv([case.scenario for case in cases()])


def train(minutes: float, processes: int, out: Path, seed: int) -> None:
    """Imitate, improve for so long, and save the policy."""
    import torch
    from stable_baselines3 import PPO
    from stable_baselines3.common.callbacks import BaseCallback
    from stable_baselines3.common.vec_env import SubprocVecEnv, VecMonitor, VecNormalize

    class Clock(BaseCallback):
        """Ends the training in time and reports on it."""

        started = 0.0

        def _on_training_start(self) -> None:
            self.started = time.monotonic()

        def _on_step(self) -> bool:
            return time.monotonic() - self.started < 60.0 * minutes

        def _on_rollout_start(self) -> None:
            costs = [-episode["r"] for episode in self.model.ep_info_buffer or ()]
            spent = (time.monotonic() - self.started) / 60.0
            if costs:
                print(f"{spent:5.1f} min, {self.num_timesteps} steps: J {np.mean(costs):.3f}", flush=True)

    torch.set_num_threads(1)
    seen, done = teacher_drives()
    drives = VecNormalize(VecMonitor(SubprocVecEnv([environment] * processes)), gamma=DISCOUNT)
    drives.obs_rms.update(seen)
    model = PPO(
        "MlpPolicy",
        drives,
        n_steps=8192 // processes,
        batch_size=512,
        n_epochs=5,
        gamma=DISCOUNT,
        learning_rate=3e-5,
        clip_range=0.1,
        use_sde=True,
        sde_sample_freq=8,
        policy_kwargs={"log_std_init": -3.0},
        seed=seed,
        device="cpu",
    )
    imitate(model, np.asarray(drives.normalize_obs(seen)), done)
    save(model, drives, out)
    model.learn(10_000_000, callback=Clock())
    save(model, drives, out)
    drives.close()


def imitate(model: Any, seen: np.ndarray, done: np.ndarray, epochs: int = 60) -> None:
    """Fit the mean action to the given ones, by least squares."""
    import torch

    network, rng = model.policy, np.random.default_rng(0)
    optimizer = torch.optim.Adam(network.parameters(), lr=2e-3)
    decay = torch.optim.lr_scheduler.CosineAnnealingLR(optimizer, epochs)
    given, wanted = (torch.as_tensor(array, dtype=torch.float32) for array in (seen, done))
    for epoch in range(epochs):
        losses = []
        for rows in np.array_split(rng.permutation(len(given)), max(1, len(given) // 256)):
            mean = network.action_net(network.mlp_extractor.forward_actor(given[rows]))
            loss = torch.mean((mean - wanted[rows]) ** 2)
            optimizer.zero_grad()
            loss.backward()
            optimizer.step()
            losses.append(float(loss.detach()))
        decay.step()
        if epoch % 20 == 19:
            print(f"imitation: rms error of the action {np.sqrt(np.mean(losses)):.3f}", flush=True)


def save(model: Any, drives: Any, out: Path) -> None:
    """Save the network and the scaling of its inputs as plain arrays."""
    network = model.policy
    layers = [network.mlp_extractor.policy_net[0], network.mlp_extractor.policy_net[2], network.action_net]
    arrays = {"mean": drives.obs_rms.mean, "sigma": np.sqrt(drives.obs_rms.var + drives.epsilon)}
    for number, layer in enumerate(layers):
        arrays[f"weight_{number}"] = layer.weight.detach().numpy()
        arrays[f"bias_{number}"] = layer.bias.detach().numpy()
    np.savez(out, **{name: array.astype(np.float32) for name, array in arrays.items()})


def main() -> None:
    """Train."""
    formatter = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=formatter)
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--out", type=Path, default=POLICY)
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args()
    train(given.minutes, given.processes, given.out, given.seed)


if __name__ == "__main__":
    main()
