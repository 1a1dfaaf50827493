"""Headroom of a drive: objective of the passive car and of the clairvoyant bound."""

from foreride.controller.clairvoyant.optimum import Optimum
from foreride.scenarios.bound.optimum_cache import bound
from foreride.scenarios.cases import Case
from foreride.scenarios.definition.schema import Scenario
from foreride.scenarios.simulation.simulate import simulate


def headroom(scenario: Scenario, known: Optimum | None = None) -> dict[str, float]:
    """`objective` of the clairvoyant bound, `gap_between_starts` of its search, and `passive_objective`.

    The bound is computed once, then taken from the cache (`scenarios.bound.optimum_cache`), unless it is
    `known`.
    """
    optimum = known or bound(scenario)
    passive = simulate(Case(scenario, "passive", "none", scenario.seed)).metrics
    return {
        "objective": optimum.objective,
        "gap_between_starts": optimum.gap,
        "passive_objective": passive["objective"],
    }
