"""Simulation of any case, the clairvoyant controller's included, which replays the optimal plan."""

from collections.abc import Callable

from foreride.controller.clairvoyant.optimum import PlanReplay
from foreride.controller.registry import CLAIRVOYANT
from foreride.scenarios.bound.optimum_cache import bound
from foreride.scenarios.cases import Case
from foreride.scenarios.simulation.simulate import Run, simulate


def simulate_case(
    case: Case, keep_images: bool = False, advance: Callable[[int], None] = lambda ticks: None
) -> Run:
    """Run of the case, as `simulate` gives it; the optimum is searched, or read from the cache."""
    replay = PlanReplay(bound(case.scenario).plan) if case.controller == CLAIRVOYANT else None
    return simulate(case, keep_images, advance, replay)
