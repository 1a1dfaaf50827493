"""Command delay line: commands issued but not yet acting, for the controller's delay compensation."""

from collections import deque
from math import ceil
from typing import NamedTuple

import numpy as np

from foreride.controller.interface import Timing


class DelayedCommand(NamedTuple):
    """Command (wheels,) that acts for `duration_s`, starting `start_s` from now."""

    start_s: float
    duration_s: float
    command: np.ndarray


class CommandDelayLine:
    """Delay line of issued commands, each of which acts `delay_s` after its issue until the next one acts.

    delay_s: at first that of the timing; at most `longest_s` longer.
    """

    def __init__(self, timing: Timing, initial: np.ndarray, longest_s: float = 0.0):
        self._timing = timing
        self._longest = _periods(timing.delay_s + longest_s, timing.period_s)
        self._initial = initial
        self.reset()

    def reset(self) -> None:
        """Fill the line with the initial command."""
        self.delay_s = self._timing.delay_s
        self._issued = deque([self._initial] * self._longest, maxlen=self._longest)

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
        count = min(_periods(self.delay_s, period), self._longest)
        if not count:
            return []
        for i, command in enumerate(list(self._issued)[self._longest - count :]):
            end = self.delay_s - (count - 1 - i) * period
            pending.append(DelayedCommand(start, end - start, command))
            start = end
        return pending


def _periods(delay_s: float, period_s: float) -> int:
    """Number of commands under way."""
    return ceil(delay_s / period_s - 1e-9)
