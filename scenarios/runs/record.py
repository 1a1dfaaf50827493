"""Run record: the fields that manifest, row of a comparison and reader of run folders share."""

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from typing import Any

from foreride.files.errors import InputError
from foreride.files.writing.sharing import shared_name, shared_target
from foreride.scenarios.definition.schema import Scenario
from foreride.scenarios.simulation.simulate import Run


@dataclass(frozen=True, kw_only=True)
class RunRecord:
    """Case of a run and what is said of it: run times, counts and qualities.

    vehicle, controller: shared names, without folders. bound: passive and clairvoyant objective, if
    requested. Fields that are Any hold what the parts of the loop report.
    """

    scenario: str
    vehicle: str
    controller: str
    perception: str
    seed: int
    timing: Any
    solver: Any
    observer_error: Any = field(default_factory=dict)
    perception_stats: Any = field(default_factory=dict)
    bound: Any = None

    @classmethod
    def of(cls, run: Run) -> "RunRecord":
        """Record of a run."""
        case = run.case
        return cls(
            scenario=case.scenario.name,
            vehicle=vehicle_name(case.scenario),
            controller=shared_target(case.controller),
            perception=case.perception,
            seed=case.seed,
            timing=run.timing,
            solver=run.solver,
            observer_error=run.observer,
            perception_stats=run.perception_stats,
            bound=run.bound,
        )

    @classmethod
    def read(cls, manifest: Mapping[str, Any], source: str) -> "RunRecord":
        """Record in a manifest, which has more fields; InputError naming `source` if one is missing."""
        names = [item.name for item in fields(cls) if item.name != "bound"]
        missing = [name for name in names if name not in manifest]
        if missing:
            raise InputError(f"{source}: its files lack {missing[0]!r}; a run of another version of foreride")
        return cls(**{name: manifest[name] for name in names}, bound=manifest.get("bound"))

    def mapping(self) -> dict[str, Any]:
        """The fields as written to files; the bound only if there is one."""
        values = {item.name: getattr(self, item.name) for item in fields(self)}
        return {name: value for name, value in values.items() if name != "bound" or value is not None}


def vehicle_name(scenario: Scenario) -> str:
    """Shared name of a scenario's car: its name in the library, or the name of its file."""
    return shared_name(scenario.vehicle.model)
