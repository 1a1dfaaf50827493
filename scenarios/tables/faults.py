"""Effect of each fault under the supervisor: `mpc_preview` against `mpc_reactive` with the same fault.

`foreride table faults`, on the reporting set. Each fault lasts WINDOW_S, from AHEAD_S before the
front axle meets the first obstacle; on roads without one, from the same time after the start. Solver faults
are injected into the solver itself, all others through the scenario.
"""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from typing import Any
from unittest.mock import patch

import numpy as np

from foreride.controller.interface import Estimate
from foreride.controller.mpc import program, qp
from foreride.controller.mpc.controller import PredictiveController
from foreride.files.writing.targets import check_files
from foreride.preview.road_preview import RoadPreview
from foreride.scenarios.definition.applicability import measures
from foreride.scenarios.definition.faults import Fault, LateAnswers, PreviewFault, SensorFault
from foreride.scenarios.definition.schema import Scenario
from foreride.scenarios.definition.sets import load_all
from foreride.scenarios.tables.options import parse_words, selected_overrides, shared_parser, whole_numbers
from foreride.scenarios.tables.runs import Variant, mean_over_events, metric, run_all, shown, write

AHEAD_S, WINDOW_S = 0.2, 1.0
LIMIT = 1.02
CHANNELS = ("body_acc", "wheel_acc", "rattle_m", "pitch_rate", "speed_m_s")

Answer = Callable[[tuple[np.ndarray, int]], tuple[np.ndarray, int]]
"""Maps the solver's answer and status to those of a faulty solver."""

SOLVER: dict[str, Answer] = {
    "solver fails": lambda found: (found[0], -4),
    "solver answers NaN": lambda found: (np.full_like(found[0], np.nan), found[1]),
}


def faults(start: float) -> dict[str, Fault]:
    """Scenario faults by name, from `start` on, s."""
    lines: dict[str, Fault] = {
        f"{channel} {mode}": SensorFault(channel, mode, start, WINDOW_S)  # type: ignore[arg-type]
        for channel in CHANNELS
        for mode in ("stuck", "silent")
    }
    lines["all sensors silent"] = SensorFault("all", "silent", start, WINDOW_S)
    lines["preview frozen"] = PreviewFault("frozen", start, WINDOW_S)
    lines["preview absurd"] = PreviewFault("absurd", start, WINDOW_S)
    lines["all answers late"] = LateAnswers(start, WINDOW_S)
    lines["20 % of answers late"] = LateAnswers(start, WINDOW_S, 0.2)
    return lines


def start_s(scenario: Scenario) -> float:
    """Start time of the fault."""
    features = scenario.road.features
    reach_m = features[0].start_m - max(scenario.vehicle.parameters.axle_x_m) if features else 0.0
    return max(0.0, (reach_m - scenario.start_m) / scenario.speed_m_s - AHEAD_S)


def names_for(scenarios: Sequence[Scenario]) -> list[str]:
    """Names of all faults that the cars of these scenarios can have."""
    cars = [scenario.vehicle.parameters for scenario in scenarios]
    return [
        name
        for name, fault in faults(0.0).items()
        if not isinstance(fault, SensorFault) or all(measures(car, fault.channel) for car in cars)
    ] + [*SOLVER]


@contextmanager
def broken_solver(answer: Answer, scenario: Scenario) -> Iterator[None]:
    """Context in which the solver returns faulty results during the scenario's window.

    A step may call the solver more than once, so the window refers to the time of the step.
    """
    rate_hz, begin, now_s = scenario.control.rate_hz, start_s(scenario), 0.0
    sound, ask = qp.minimise, PredictiveController.step

    def step(controller: PredictiveController, estimate: Estimate, preview: RoadPreview | None) -> np.ndarray:
        nonlocal now_s
        now_s = round(estimate.time_s * rate_hz) / rate_hz
        return ask(controller, estimate, preview)

    def solve(*program: Any) -> tuple[np.ndarray, int]:
        found = sound(*program)
        return answer(found) if begin <= now_s < begin + WINDOW_S else found

    with (
        patch.object(PredictiveController, "step", step),
        patch.object(program, "solve_stages", lambda *_: None),  # every step asks the general solver
        patch.object(qp, "minimise", solve),
    ):
        yield


def variants(name: str, scenarios: list[Scenario]) -> list[Variant]:
    """`mpc_preview` and `mpc_reactive` with one fault, or without any."""
    pair = (("mpc_preview", "oracle"), ("mpc_reactive", "none"))
    spoilt = scenarios
    if name in faults(0.0):
        spoilt = [replace(scenario, faults=(faults(start_s(scenario))[name],)) for scenario in scenarios]
    answer = SOLVER.get(name)
    around = {} if answer is None else {"around": lambda scenario: broken_solver(answer, scenario)}
    return [Variant(f"{name}, {c}", c, seen, spoilt, **around) for c, seen in pair]


def main(arguments: Sequence[str] | None = None) -> None:
    """Simulate, print the table, and write JSON if requested. Raises InputError."""
    parser = shared_parser("faults", "mpc_preview and its supervisor under faults", seeds="0")
    parser.add_argument("--lines", help="names of the lines, separated by commas (default all)")
    asked = parser.parse_args(arguments)
    check_files(asked.json)
    scenarios = load_all(asked.events, selected_overrides(asked))
    known = names_for(scenarios)
    names = parse_words("--lines", asked.lines, known) if asked.lines else known
    wanted = [variant for name in ("no fault", *names) for variant in variants(name, scenarios)]
    done = run_all(wanted, whole_numbers("--seeds", asked.seeds), asked.read)
    sound = metric(done["no fault, mpc_reactive"], "objective")
    print(f"\n{asked.vehicle} car, {len(scenarios)} events, seeds {asked.seeds}; at most {LIMIT}\n")
    print("| fault | J / mpc_reactive with it | worst event | J / mpc_reactive without it | fallbacks |")
    print("|---|---|---|---|---|")
    for name in ("no fault", *names):
        runs = done[f"{name}, mpc_preview"]
        objective = metric(runs, "objective")
        ratio = objective / metric(done[f"{name}, mpc_reactive"], "objective")
        verdict = "" if (mean := mean_over_events(ratio)).mean <= LIMIT else " **over**"
        fallbacks = np.mean([one["solver"]["fallbacks"] for of_seed in runs for one in of_seed])
        worst = ratio.mean(axis=0)
        print(
            f"| {name} | {shown(mean)}{verdict} | {worst.max():.3f} ({scenarios[int(worst.argmax())].name})"
            f" | {shown(mean_over_events(objective / sound))} | {fallbacks:.0f} a drive |"
        )
    write(asked.json, done)
