"""Loop block: a whole drive, from perception to the car, stepped from outside."""

from typing import Any

import numpy as np

from foreride.scenarios.cases import Case
from foreride.scenarios.definition.clock import TICKS_PER_SECOND
from foreride.scenarios.fmu.block import Port
from foreride.scenarios.fmu.signals import signal_ports, values_now
from foreride.scenarios.simulation.recorded_signals import flat_signals
from foreride.scenarios.simulation.simulate import assembled


class LoopBlock:
    """Drive of a case; it has no inputs, and stands still at its last instant when the road has ended."""

    def __init__(self, case: Case) -> None:
        """Assemble the loop at the beginning of the drive."""
        self.step_s = 1.0 / case.scenario.control.rate_hz
        self.duration_s = case.scenario.ticks / TICKS_PER_SECOND
        self._case = case
        self.inputs: dict[str, float] = {}
        self.reset()
        self.ports: tuple[Port, ...] = signal_ports(self._plant.state, left_out=("time_s",))

    def reset(self) -> None:
        """Return to the beginning of the drive."""
        self._loop, self._plant, self._perception = assembled(self._case)
        self._driven_ticks = self._tick = 0
        self._drive = self._loop.controlled(self._count)
        self._recorded: dict[str, np.ndarray] = {}
        self._recorded_from = 0

    def advance(self, ticks: int) -> None:
        """Drive on, at least to the end of the step; the loop proceeds from event to event."""
        self._tick = min(self._tick + ticks, self._case.scenario.ticks)
        while self._driven_ticks < self._tick:
            before = self._driven_ticks
            next(self._drive, None)
            if (driven := self._driven_ticks - before) > 0:
                self._recorded = flat_signals(self._plant.recent(driven))
                self._recorded_from = before + 1
        if self._driven_ticks >= self._case.scenario.ticks:
            self._perception.close()

    def outputs(self) -> dict[str, float]:
        """Signals of the car now."""
        if self._tick == 0:
            return values_now(self._plant.state)
        place = self._tick - self._recorded_from
        return {name: float(values[place]) for name, values in self._recorded.items()}

    def state(self) -> dict[str, Any]:
        """Return nothing: the loop's state cannot be saved."""
        return {}

    def restore(self, state: dict[str, Any]) -> None:
        """Do nothing."""

    def _count(self, ticks: int) -> None:
        self._driven_ticks += ticks
