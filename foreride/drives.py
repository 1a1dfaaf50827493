"""Drives from Python: one, several beside each other, and the bound of what any controller could reach."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

from foreride.controller.interface import Controller
from foreride.controller.registry import build_object, uses_preview
from foreride.controller.user_controller import controller_label
from foreride.files.errors import InputError, shown
from foreride.files.reading.numbers import within
from foreride.results import Comparison, Result
from foreride.scenarios.bound.headroom import headroom
from foreride.scenarios.bound.simulate_case import simulate_case
from foreride.scenarios.cases import Case
from foreride.scenarios.comparison.parallel import simulate_each
from foreride.scenarios.definition.loading import load
from foreride.scenarios.definition.schema import Scenario
from foreride.scenarios.runs import read as run_folder
from foreride.scenarios.simulation.referenced_files import check_case_files
from foreride.scenarios.simulation.simulate import simulate

Fields = Mapping[str, Any]
"""Fields of a scenario to replace: `{"camera": {"latency_s": 0.1}}` or `{"camera.latency_s": 0.1}`."""
DEFAULT_BASELINE = "passive"
AnyController = str | Controller | Callable[..., Controller]
"""A name, `file.py:name`, a class or function called with (vehicle, timing), or an object."""


def load_scenario(scenario: str | Path | Scenario, overrides: Fields | None = None) -> Scenario:
    """Read a scenario by its name in the library or from a file, with overrides. Raises InputError."""
    if isinstance(scenario, Scenario):
        if overrides:
            raise InputError("overrides apply to the name or file of a scenario, not to one already loaded")
        return scenario
    return load(str(scenario), overrides or {})


def run(
    scenario: str | Path | Scenario,
    controller: AnyController = "mpc_preview",
    perception: str = "oracle",
    seed: int | None = None,
    overrides: Fields | None = None,
    keep_images: bool = False,
) -> Result:
    """Drive one scenario and return its result; the same arguments give the same result, bit for bit.

    perception: none, oracle, map, boxes or camera. seed: None for the scenario's own. keep_images: keep what
    the camera saw, for reports and films. Raises InputError for anything invalid.
    """
    loaded = load_scenario(scenario, overrides)
    case = Case(
        loaded, controller_label(controller), perception, _seed(loaded.seed if seed is None else seed)
    )
    return _drive(case, controller, keep_images)


def compare(
    scenarios: str | Path | Scenario | Sequence[str | Path | Scenario],
    controllers: AnyController | Sequence[AnyController] = (
        "passive",
        "skyhook",
        "mpc_reactive",
        "mpc_preview",
    ),
    perceptions: str | Sequence[str] = ("oracle",),
    seeds: Sequence[int] | None = None,
    overrides: Fields | None = None,
    baseline: str | None = DEFAULT_BASELINE,
    jobs: int = 1,
) -> Comparison:
    """Drive scenarios x seeds x controllers x perceptions; a controller without preview drives once.

    seeds: None for each scenario's own. baseline: the controller that effects are relative to; None for
    absolute values. jobs: worker processes for controllers given by name, in a script under
    `if __name__ == "__main__":`. The number of jobs changes no result. Raises InputError.
    """
    several = [scenarios] if isinstance(scenarios, str | Path | Scenario) else list(scenarios)
    laws = list(controllers) if isinstance(controllers, list | tuple) else [cast(AnyController, controllers)]
    perceptions = [perceptions] if isinstance(perceptions, str) else perceptions
    loaded = [load_scenario(scenario, overrides) for scenario in several]
    labels = [controller_label(controller) for controller in laws]
    if len(set(labels)) != len(labels):
        raise InputError(f"controllers must have different names, got {', '.join(labels)}")
    if baseline not in (*labels, None, DEFAULT_BASELINE):
        raise InputError(f"baseline must be one of {', '.join(labels)}, got {shown(baseline)}")
    within("jobs", jobs, 1, 1024)
    drives = [
        (Case(scenario, controller_label(controller), perception, _seed(seed)), controller)
        for scenario in loaded
        for seed in (seeds if seeds is not None else [scenario.seed])
        for controller in laws
        for perception in (perceptions if _takes_preview(controller) else ["none"])
    ]
    return Comparison(tuple(_simulated(drives, jobs)), baseline if baseline in labels else None)


@dataclass(frozen=True)
class Bound:
    """Bound of a drive: J of the clairvoyant optimum and of the passive car, (m/s²)².

    gap_between_starts: relative difference of J between the searches from different starts.
    """

    objective: float
    passive_objective: float
    gap_between_starts: float


def bound(scenario: str | Path | Scenario, overrides: Fields | None = None) -> Bound:
    """Search the optimum of a drive whose road is known, which no controller can beat, or read it from cache.

    A search takes from seconds to minutes. Raises InputError for an invalid scenario.
    """
    return Bound(**headroom(load_scenario(scenario, overrides)))


def load_run(folder: Path | str) -> Result:
    """Read a run folder, as `Result.save` and `foreride run` write it. Raises InputError if it is damaged."""
    return Result(run_folder.read(Path(folder)))


def _seed(seed: int) -> int:
    within("seed", seed, 0, 2**32 - 1)
    return int(seed)


def _takes_preview(controller: AnyController) -> bool:
    return not isinstance(controller, str) or uses_preview(controller)


def _simulated(drives: Sequence[tuple[Case, AnyController]], jobs: int) -> Iterator[Result]:
    """Results in order; controllers given by name are simulated in worker processes, if there are several."""
    named = [case for case, controller in drives if isinstance(controller, str)]
    for case in named:
        check_case_files(case)
    runs = simulate_each(named, jobs, keep_images=False)
    for case, controller in drives:
        yield Result(next(runs)) if isinstance(controller, str) else _drive(case, controller)


def _drive(case: Case, controller: AnyController, keep_images: bool = False) -> Result:
    if isinstance(controller, str):
        check_case_files(case)
        return Result(simulate_case(case, keep_images))
    control, car = case.scenario.control, case.scenario.vehicle.parameters
    timing = control.timing
    built = build_object(controller, car, control.settings, timing)
    return Result(simulate(case, keep_images, controller=built))
