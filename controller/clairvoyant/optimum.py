"""Clairvoyant optimum: the optimal open-loop plan for a whole drive, and its replay.

A lower bound for J on that drive. Direct single shooting on the exact model
(`controller.clairvoyant.single_shooting`) with limits on every command, minimised by L-BFGS-B (Byrd, Lu,
Nocedal & Zhu, SIAM J. Sci. Comput. 16(5), 1995). The problem is not convex, so it is solved from several
starts; the spread of their results shows how tight the best one is.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from foreride.controller.clairvoyant.single_shooting import WholeDriveObjective
from foreride.controller.command_limits import KILO, plan_limits
from foreride.controller.interface import BaseController, Estimate
from foreride.preview.road_preview import RoadPreview
from foreride.vehicle.load import Car

RELATIVE_TOLERANCE = 1e-8
"""Convergence tolerance: relative decrease of J per iteration."""
MAX_ITERATIONS = 4000


@dataclass(frozen=True, eq=False)
class Optimum:
    """Best local optimum over all starts.

    plan: (intervals, inputs), kN·s/m and kN. objective: its J. objectives: J reached from each start, by
    name.
    """

    plan: np.ndarray
    objective: float
    objectives: dict[str, float]

    @property
    def gap(self) -> float:
        """Relative excess of J of the worst start over that of the best."""
        return max(self.objectives.values()) / self.objective - 1.0


def optimise(vehicle: Car, drive: WholeDriveObjective, starts: Mapping[str, np.ndarray]) -> Optimum:
    """Minimise J from each start (intervals, inputs) and return the best result.

    A search that stops before convergence counts like the others: its plan is feasible and attains its J.
    """
    from scipy.optimize import minimize  # slow to import, and every drive imports this module

    low, high = (np.tile(limit, drive.intervals) for limit in plan_limits(vehicle))
    best: np.ndarray | None = None
    objectives: dict[str, float] = {}
    for name, start in starts.items():
        scale, _ = drive.objective(start)
        search = minimize(
            lambda plan, scale=scale: tuple(part / scale for part in drive.objective(plan)),
            np.clip(start.ravel(), low, high),
            jac=True,
            method="L-BFGS-B",
            bounds=np.stack([low, high], axis=1),
            options={
                "maxcor": 20,
                "ftol": RELATIVE_TOLERANCE,
                "gtol": 0.0,
                "maxiter": MAX_ITERATIONS,
                "maxfun": 10**6,
            },
        )
        objectives[name], _ = drive.objective(search.x)
        if best is None or objectives[name] <= min(objectives.values()):
            best = search.x
    assert best is not None, "at least one start"
    return Optimum(best.reshape(drive.intervals, -1), min(objectives.values()), objectives)


class PlanReplay(BaseController):
    """Open-loop controller that issues the commands of a plan in turn and then holds the last one."""

    def __init__(self, plan: np.ndarray):
        self._plan = plan
        self.reset()

    def reset(self) -> None:
        """Return to the start of the plan."""
        self._issued_count = 0

    def step(self, estimate: Estimate, preview: RoadPreview | None) -> np.ndarray:
        """Return the next command (inputs,), N·s/m and N."""
        command = KILO * self._plan[min(self._issued_count, len(self._plan) - 1)]
        self._issued_count += 1
        return command
