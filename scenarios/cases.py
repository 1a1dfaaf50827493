"""Cases of a comparison: combinations of scenario, seed, controller and perception."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from foreride.controller.registry import uses_preview
from foreride.files.errors import InputError
from foreride.scenarios.definition.schema import Scenario
from foreride.scenarios.perceptions.registry import perception_entry


@dataclass(frozen=True)
class Case:
    """Case: one run of a scenario with one controller, one perception and one seed."""

    scenario: Scenario
    controller: str
    perception: str
    seed: int

    def __post_init__(self) -> None:
        perception_entry(self.perception)


def cases(
    scenarios: Sequence[Scenario],
    controllers: Sequence[str],
    perceptions: Sequence[str],
    seeds: Sequence[int] | None = None,
) -> list[Case]:
    """Scenarios x seeds x controllers x perceptions, in that order.

    A controller without preview runs once, with perception `none`, whatever perceptions are requested.
    `seeds` None leaves each scenario its own seed.
    """
    return [
        Case(scenario, controller, perception, seed)
        for scenario in scenarios
        for seed in (seeds if seeds is not None else [scenario.seed])
        for controller in controllers
        for perception in (perceptions if uses_preview(controller) else ["none"])
    ]


def distinct(wanted: Iterable[Case]) -> list[Case]:
    """Remove duplicate cases; InputError for different scenarios of one name, as their runs would mix."""
    kept: dict[tuple[str, str, str, str, int], Case] = {}
    for case in wanted:
        scenario = case.scenario
        key = (scenario.name, scenario.vehicle.model, case.controller, case.perception, case.seed)
        if kept.setdefault(key, case).scenario.mapping != scenario.mapping:
            raise InputError(
                f"scenarios must differ in their `name`, got two that are called {scenario.name}"
            )
    return list(kept.values())
