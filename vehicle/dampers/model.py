"""Damper model: base class of all dampers, and the ideal damper.

Every damper receives a setting between the corner's damping_min_ns_m and damping_max_ns_m and follows it with
a first-order lag, which represents current and valve. For `IdealDamper` the setting is the damping
coefficient; for the others `normalised_setting`, 0 ... 1, is the position of the setting in its range and in
the current range. A gas spring inside a damper belongs to the car's spring.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, ClassVar

from foreride.files.reading.ranges import Checked
from foreride.vehicle.arithmetic import FLOATS


class DamperModel(Checked):
    """Base of the dampers: frozen dataclasses that carry their name as `kind`.

    internal_states: number of internal states, 0 at rest. substeps: integration steps per tick (1 ms) that
    the plant needs. rate_steps: Runge-Kutta steps of the internal states in each of those.

    A damper gives `force` and, if it has internal states, `internal_state_rates`, for travel and rate of the
    suspension (positive: extending) in any arithmetic `xp` of `vehicle.equations`.
    """

    kind: ClassVar[str]
    internal_states: ClassVar[int] = 0
    substeps: ClassVar[int] = 1
    rate_steps: ClassVar[int] = 4

    def force(
        self, setting: Any, normalised_setting: Any, travel: Any, rate: Any, internal_states: list, xp: Any
    ) -> Any:
        """Force on the body, up, N."""
        raise NotImplementedError

    def internal_state_rates(
        self, normalised_setting: Any, travel: Any, rate: Any, internal_states: list, xp: Any
    ) -> list:
        """Time derivatives of the internal states."""
        if self.internal_states:
            raise NotImplementedError
        return []

    def advance(
        self, normalised_setting: float, travel: float, rate: float, internal_states: list, step_s: float
    ) -> list:
        """Internal states after a step at constant setting and rate; `travel` is that of the step's middle.

        By default classical Runge-Kutta in `rate_steps` steps, stable for time constants of at least 0.4 of
        such a step.
        """
        step, states = step_s / self.rate_steps, internal_states
        travel -= 0.5 * step_s * rate

        def slopes(values: list, at: float) -> list:
            return self.internal_state_rates(normalised_setting, travel + at * rate, rate, values, FLOATS)

        for number in range(self.rate_steps):
            states = _runge_kutta(slopes, states, number * step, step)
        return states

    def midway(
        self, normalised_setting: float, travel: float, rate: float, internal_states: list, step_s: float
    ) -> list:
        """Internal states in the middle of the same step."""
        quarter = travel - 0.25 * step_s * rate
        return self.advance(normalised_setting, quarter, rate, internal_states, 0.5 * step_s)

    def reduced(self, steepest_ns_m: float) -> "DamperModel":
        """Reduced model for controllers: without internal states, not steeper than that at zero rate.

        By default the damper itself, or an ideal one in place of a damper with internal states.
        """
        return IdealDamper() if self.internal_states else self


def _runge_kutta(slopes: Callable[[list, float], list], states: list, at: float, step: float) -> list:
    """States after one step of the classical fourth-order method that begins at `at`."""

    def moved(rates: list, by: float) -> list:
        return [state + by * rate for state, rate in zip(states, rates, strict=True)]

    first = slopes(states, at)
    second = slopes(moved(first, 0.5 * step), at + 0.5 * step)
    third = slopes(moved(second, 0.5 * step), at + 0.5 * step)
    fourth = slopes(moved(third, step), at + step)
    mean = [(a + 2 * b + 2 * c + d) / 6 for a, b, c, d in zip(first, second, third, fourth, strict=True)]
    return moved(mean, step)


@dataclass(frozen=True)
class IdealDamper(DamperModel):
    """Ideal linear damper of variable coefficient: force = -setting · rate."""

    kind: ClassVar[str] = "ideal"

    def force(
        self, setting: Any, normalised_setting: Any, travel: Any, rate: Any, internal_states: list, xp: Any
    ) -> Any:
        """Force on the body, up, N."""
        return -setting * rate
