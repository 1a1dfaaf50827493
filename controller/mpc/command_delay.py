"""Command delay line: commands issued but not yet acting, for the controller's delay compensation."""

from collections import deque
from typing import NamedTuple

import numpy as np

from foreride.controller.interface import Timing


class DelayedCommand(NamedTuple):
    """Command (wheels,) that acts for `duration_s`, starting `start_s` from now."""

    start_s: float
    duration_s: float
    command: np.ndarray


class CommandDelayLine:
    """Delay line of issued commands, each of which acts `delay_s` after its issue until the next one acts."""

    def __init__(self, timing: Timing, initial: np.ndarray):
        self._timing = timing
        self._count = int(np.ceil(timing.delay_s / timing.period_s - 1e-9))
        self._initial = initial
        self.reset()

    def reset(self) -> None:
        """Fill the line with the initial command."""
        self._issued = deque([self._initial] * self._count, maxlen=self._count)

    def issue(self, command: np.ndarray) -> None:
        """Append the command issued now."""
        self._issued.append(command)

    def replace_last(self, command: np.ndarray) -> None:
        """Replace the last command by the one that was issued in its place."""
        if self._issued:
            self._issued[-1] = command

    def pending(self) -> list[DelayedCommand]:
        """Return the commands that act from now until one issued now would act; empty without delay."""
        period, pending, start = self._timing.period_s, [], 0.0
        for i, command in enumerate(self._issued):
            end = self._timing.delay_s - (self._count - 1 - i) * period
            pending.append(DelayedCommand(start, end - start, command))
            start = end
        return pending
