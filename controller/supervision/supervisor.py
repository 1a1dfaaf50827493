"""Fallback supervisor: the selected controller, then a reactive law, then fixed damping.

The tuned reactive law named in the settings needs only the state of the car; fixed damping needs nothing. An
invalid preview is merely withheld: the controller then relies on the measured road alone.
"""

from math import isfinite
from typing import Any

import numpy as np

from foreride.controller.command_limits import command_limits, full_command
from foreride.controller.interface import ALL_SILENT, Controller, Estimate, MonitoredController, Timing
from foreride.controller.settings import SupervisorSettings
from foreride.controller.supervision.preview_gate import PreviewGate
from foreride.controller.supervision.step_statistics import ControllerStatistics
from foreride.files.errors import InputError
from foreride.files.jit import njit
from foreride.preview.road_preview import RoadPreview
from foreride.vehicle.load import Car
from foreride.vehicle.plant.sensors import Measurement

MAX_LEVEL_M = 1.0
"""Largest difference of previewed and estimated height under a wheel, which have no common level, m."""


class FallbackSupervisor:
    """Controller with a reactive law and fixed damping as fallbacks, effective in the sample that fails.

    Changes from one to the other are bumpless: the command starts at the last one and the difference decays
    with the time constant `transfer_s`.
    """

    def __init__(
        self,
        controller: MonitoredController,
        reactive: Controller,
        safe: Controller,
        vehicle: Car,
        settings: SupervisorSettings,
        timing: Timing,
    ):
        self._controller, self._reactive, self._safe = controller, reactive, safe
        self._vehicle, self._settings = vehicle, settings
        self._low, self._high = command_limits(vehicle)
        self._period_s = timing.period_s
        self._fade = float(np.exp(-timing.period_s / settings.transfer_s)) if settings.transfer_s else 0.0
        self.reset()

    def reset(self) -> None:
        """Clear the internal state and the statistics."""
        for controller in (self._controller, self._reactive, self._safe):
            controller.reset()
        self._acting: Controller | None = None
        self._last = np.zeros(len(self._low))
        self._offset, self._fading = np.zeros(len(self._low)), False
        self._gate = PreviewGate(self._vehicle, self._settings.gate)
        self._statistics = ControllerStatistics()

    @property
    def stats(self) -> dict[str, Any]:
        """Numbers of `solves` and `fallbacks`, and `median_ms` and `max_ms` of a step.

        reasons: {problem: steps}. active: {constraint: steps in which it was active}.
        """
        return self._statistics.summary()

    @property
    def problem(self) -> str | None:
        """Reason for the fallback of the last step, or None."""
        return self._statistics.problem

    @property
    def active(self) -> tuple[str, ...]:
        """Names of the constraints active in the last step; none after a fallback."""
        return self._statistics.active

    def step(self, estimate: Estimate, preview: RoadPreview | None) -> np.ndarray:
        """Return the command (inputs,), N·s/m and N."""
        self._statistics.start()
        unseen = preview_problem(preview, estimate, self._period_s, self._settings)
        finite = estimate.is_finite()
        if preview is not None and finite and not (unseen or estimate.faults):
            unseen = self._gate.check(estimate, preview)
        problem: str | None = "estimate not finite"
        answer = self._last
        if finite:
            problem, answer = self._evaluate(estimate, preview if unseen is None else None)
        if problem is None:
            command = self._transfer(self._controller, answer)
        else:
            blind = ALL_SILENT in estimate.faults or not finite
            acting = self._safe if blind else self._reactive
            command = self._transfer(acting, full_command(self._vehicle, acting.step(estimate, None)))
        self._controller.acted(command)
        active = self._controller.active if problem is None else ()
        self._statistics.finish(problem or unseen, active)
        return command

    def sensed(self, measurement: Measurement) -> None:
        """Pass the sensors' readings on."""
        self._controller.sensed(measurement)

    def acted(self, command: np.ndarray) -> None:
        """Do nothing: the command issued is its own."""

    def _evaluate(self, estimate: Estimate, preview: RoadPreview | None) -> tuple[str | None, np.ndarray]:
        """Evaluate the controller; return the reason to reject its answer, or None, and the answer.

        The estimate is finite.
        """
        wheels = self._vehicle.wheels
        answer = np.asarray(self._controller.step(estimate, preview), dtype=float)
        if answer.shape not in ((wheels,), self._low.shape):
            allowed = " or ".join(f"({n},)" for n in sorted({wheels, len(self._low)}))
            raise InputError(f"a controller's command must have shape {allowed}, got {answer.shape}")
        if estimate.faults:
            return "; ".join(estimate.faults), answer
        if problem := self._controller.problem:
            return problem, answer
        if not all(map(isfinite, answer.tolist())):
            return "command not finite", answer
        return None, full_command(self._vehicle, answer)

    def _transfer(self, acting: Controller, wanted: np.ndarray) -> np.ndarray:
        """Bumpless transfer: approach the command `wanted` of the acting controller without a jump."""
        if self._acting is not None and acting is not self._acting:
            self._offset, self._fading = self._last - wanted, True
        self._acting = acting
        if self._fading:
            self._offset = self._fade * self._offset
            self._fading = bool((np.abs(self._offset) > 1.0).any())
        if not self._fading:
            self._last = wanted
            return wanted.copy()
        self._last = np.clip(wanted + self._offset, self._low, self._high)
        return self._last.copy()


def preview_problem(
    preview: RoadPreview | None, estimate: Estimate, period_s: float, settings: SupervisorSettings
) -> str | None:
    """Reason why a preview is invalid; None for a valid preview and for none."""
    if preview is None:
        return None
    if preview.wheels != len(estimate.road_height):
        return "preview of another car"
    if preview.age_s > settings.stale_s or abs(estimate.time_s - preview.time_s) > 0.5 * period_s:
        return "stale preview"
    heights = preview.distance_m, preview.height_m, preview.height_here_m
    if _is_absurd(*heights, estimate.road_height, settings.highest_m):
        return "absurd preview"
    return None


@njit
def _is_absurd(distance: Any, heights: Any, here: Any, road: Any, highest_m: float) -> bool:
    """Whether finite heights, or those under the wheels, are farther from one another than roads are."""
    for wheel in range(len(here)):
        if abs(here[wheel] - road[wheel]) > MAX_LEVEL_M:
            return True
    return bool(relief_m(distance, heights) > highest_m)


@njit(fastmath={"reassoc", "nnan"})
def relief_m(distance: Any, heights: Any) -> float:
    """Relief of finite heights, m: the greatest departure from their own straight lines, or rise in a metre.

    The grade of a preview says nothing of its soundness: a road ahead may climb. Sums in any order and
    comparisons are taken several at once.
    """
    n, middle, spread, relief = len(distance), 0.0, 0.0, 0.0
    metre = max(1, int(1.0 / (distance[1] - distance[0]) + 0.5))
    for i in range(n):
        middle += distance[i]
    middle /= n
    for i in range(n):
        spread += (distance[i] - middle) ** 2
    for wheel in range(len(heights)):
        row, mean, grade = heights[wheel], 0.0, 0.0
        for i in range(n):
            mean += row[i]
            grade += row[i] * (distance[i] - middle)
        mean, grade = mean / n, grade / spread
        for i in range(n):
            relief = max(relief, abs(row[i] - mean - grade * (distance[i] - middle)))
        for i in range(metre, n):
            relief = max(relief, abs(row[i] - row[i - metre]))
    return relief
