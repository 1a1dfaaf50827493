"""Gymnasium environment in which an agent sets the dampers of a car that drives through a scenario."""

from collections.abc import Generator, Sequence
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np

from foreride.controller.command_limits import command_limits
from foreride.controller.interface import BaseController
from foreride.files.errors import InputError
from foreride.scenarios.cases import Case
from foreride.scenarios.definition.loading import load
from foreride.scenarios.definition.overrides import Overrides
from foreride.scenarios.definition.schema import Scenario
from foreride.scenarios.gym.observation import ObservationLayout
from foreride.scenarios.simulation.multirate_loop import Decision
from foreride.scenarios.simulation.recorded_signals import RecordedSignals
from foreride.scenarios.simulation.running_metrics import RunningMetrics
from foreride.scenarios.simulation.simulate import assembled, metrics_of

Array = np.ndarray


def _loaded(scenario: str | Path | Scenario, overrides: Overrides) -> Scenario:
    if not isinstance(scenario, Scenario):
        return load(str(scenario), overrides)
    if overrides:
        raise InputError("overrides apply to the name or file of a scenario, not to one already loaded")
    return scenario


class _Agent(BaseController):
    """Place of the controller in the loop; the agent's commands come from outside."""

    def step(self, estimate: Any, preview: Any) -> Array:
        raise NotImplementedError("the agent decides")


class DamperEnv(gymnasium.Env[Array, Array]):
    """One step is one period of `control.rate_hz`; an episode is one drive, truncated at its end.

    observation: see `ObservationLayout`, SI units. action: (inputs,) from -1 to 1 for the lowest to the
    highest damping coefficient of each wheel's damper (N·s/m) and, after them, actuator force (N).
    reward: minus the cost of the step (`RunningMetrics`) divided by the ticks of the drive, so that the
    return is minus the drive's J. The info of the last step holds the ride metrics under `metrics`.
    """

    metadata = {"render_modes": []}  # noqa: RUF012 (Gymnasium's own declaration)

    def __init__(
        self,
        scenario: str | Path | Scenario | Sequence[str | Path | Scenario] = "hump_flat_30",
        perception: str = "oracle",
        overrides: Overrides = (),
    ) -> None:
        """Prepare for one scenario, or for several of one car, of which each episode draws one.

        Raises InputError for an invalid scenario or perception, or cars that differ in wheels or limits.
        """
        several = [scenario] if isinstance(scenario, str | Path | Scenario) else list(scenario)
        self.scenarios = [_loaded(each, overrides) for each in several]
        if not self.scenarios:
            raise InputError("scenario must name one or more scenarios, got none")
        cars = [each.vehicle.parameters for each in self.scenarios]
        self.layout = ObservationLayout.of(cars[0])
        self._low, self._high = command_limits(cars[0])
        for car in cars[1:]:
            limits = np.array([self._low, self._high])
            if ObservationLayout.of(car) != self.layout or not np.array_equal(command_limits(car), limits):
                raise InputError("scenario: all must have cars of the same wheels, states and damper limits")
        Case(self.scenarios[0], "passive", perception, 0)
        self.perception = perception
        entries = (len(self.layout.names),)
        self.observation_space = gymnasium.spaces.Box(-np.inf, np.inf, entries, np.float32)
        self.action_space = gymnasium.spaces.Box(-1.0, 1.0, self._low.shape, np.float32)
        self._drive: Generator[Decision, Array | None, None] | None = None

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Array, dict[str, Any]]:
        """Start a drive; the same seed gives the same scenario, sensor noise and detections."""
        super().reset(seed=seed)
        scenario = self.scenarios[int(self.np_random.integers(len(self.scenarios)))]
        drawn = int(self.np_random.integers(2**32))
        self.close()
        self._case = Case(scenario, "passive", self.perception, drawn if seed is None else seed % 2**32)
        self._loop, self._plant, self._perception = assembled(self._case, controller=_Agent())
        self._cost = RunningMetrics(scenario.tyre_load_weight)
        self._added_ticks = self._driven_ticks = 0
        self._drive = self._loop.decisions(self._count)
        self._seen = self._observation(next(self._drive))
        return self._seen, {"scenario": scenario.name, "seed": self._case.seed}

    def step(self, action: Array) -> tuple[Array, float, bool, bool, dict[str, Any]]:
        """Command the dampers for one period. Raises InputError before `reset` or for a wrong action."""
        if self._drive is None:
            raise InputError("step: the drive has ended or not begun; call reset first")
        try:
            decision = self._drive.send(self._command(action))
        except StopIteration:
            reward = self._reward()
            self.close()
            metrics = metrics_of(RecordedSignals(self._plant), self._case)
            return self._seen, reward, False, True, {"metrics": metrics}
        self._seen = self._observation(decision)
        return self._seen, self._reward(), False, False, {}

    def close(self) -> None:
        """Release the perception of the present drive, if one is under way."""
        if self._drive is not None:
            self._drive.close()
            self._perception.close()
            self._drive = None

    def _count(self, ticks: int) -> None:
        self._driven_ticks += ticks

    def _observation(self, decision: Decision) -> Array:
        return self.layout.vector(decision.estimate, decision.preview)

    def _command(self, action: Array) -> Array:
        """Command in N·s/m and N, clipped to the limits."""
        given = np.asarray(action, dtype=float)
        if given.shape != self._low.shape or not np.isfinite(given).all():
            raise InputError(f"action must be {len(self._low)} finite numbers, got {given.tolist()}")
        share = (np.clip(given, -1.0, 1.0) + 1.0) / 2.0
        return self._low + share * (self._high - self._low)

    def _reward(self) -> float:
        """Minus the mean cost of the ticks since the last reward, as a part of the drive's."""
        count = self._driven_ticks - self._added_ticks
        first = self._added_ticks == 0  # the standstill at time zero is recorded, too
        self._added_ticks = self._driven_ticks
        cost = self._cost.add(self._plant.recent(count + first))
        return -cost / (self._case.scenario.ticks + 1)
