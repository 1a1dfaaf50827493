"""Validation check: one row of the table, and the comparison of arrays for it."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike


@dataclass(frozen=True)
class Check:
    """Result of a comparison: subject, reference, deviation and permitted deviation.

    deviation and bound are >= 0 and in `unit`; "" is a ratio. A deviation that is not a number fails.
    """

    name: str
    reference: str
    deviation: float
    bound: float
    unit: str = ""

    @property
    def passed(self) -> bool:
        """Whether the deviation is inside the bound."""
        return bool(self.deviation <= self.bound)


Checks = tuple[Callable[[], Check], ...]
"""Checks of one area: functions without arguments, each returning one row."""


def relative(found: ArrayLike, expected: ArrayLike) -> float:
    """Maximum of |found / expected - 1| over all elements."""
    return float(np.max(np.abs(np.asarray(found, float) / np.asarray(expected, float) - 1)))
