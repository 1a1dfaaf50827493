"""Run time of the predictive controllers' step, by part: `python -m benchmarks.bench_mpc [--json FILE]`.

Each row is a car and a control period with the default horizon; times are medians of processor time.
"""

import argparse
import json
from collections.abc import Callable
from pathlib import Path
from time import process_time

import numpy as np

from controller.base import Estimate, Timing
from controller.mpc import PredictiveController
from controller.qp import solve_box
from files.atomic import write_text
from preview.horizon import RoadPreview, distance_grid
from vehicle.equations import rest_state
from vehicle.parameters import Car, load_vehicle

CASES = [("quarter", 0.01), ("quarter", 0.005), ("half", 0.01), ("half", 0.005), ("full", 0.01)]
SPEED_M_S = 10.0


def situations(vehicle: Car, count: int, seed: int = 0) -> list[tuple[Estimate, RoadPreview]]:
    """A car shaken at random before a wavy road."""
    rng = np.random.default_rng(seed)
    grid, rest = distance_grid(0.5, 10.0), rest_state(vehicle)
    ones, zero = np.ones((vehicle.wheels, len(grid))), np.zeros(vehicle.wheels)
    pairs = []
    for _ in range(count):
        x = rest + np.where(rest > 0, 0.0, 0.1) * rng.standard_normal(len(rest))
        preview = RoadPreview(0.0, grid, 0.05 * ones * np.sin(2 * grid), 0 * ones, 0 * ones, ones)
        pairs.append((Estimate(0.0, x, zero, zero, SPEED_M_S, np.ones(vehicle.wheels, dtype=bool)), preview))
    return pairs


def median_ms(calls: list[Callable[[], object]]) -> float:
    """Median time of the calls, the first of which warm up."""
    times = []
    for call in calls:
        start = process_time()
        call()
        times.append(process_time() - start)
    return 1e3 * float(np.median(times[len(times) // 10 :]))


def measure(car: str, period_s: float, count: int) -> dict[str, object]:
    """One row: the whole step, and within it preparation (rollout, condensing) and the quadratic program."""
    vehicle = load_vehicle(car)
    controller = PredictiveController(vehicle, timing=Timing(period_s))
    pairs = situations(vehicle, count)
    step = median_ms([lambda pair=pair: controller.step(*pair) for pair in pairs])  # type: ignore[misc]
    condense = controller._condense
    state, plan = condense.states[:, 0].copy(), controller._plan.copy()
    road = controller._road.heights(controller._node_times)
    prepare = median_ms([lambda: condense(state, plan, road)] * count)
    program = condense(state, plan, road)
    low, high = ((limit - plan).ravel() for limit in (controller._low, controller._high))
    solve = median_ms([lambda: solve_box(program.hessian, program.gradient, low, high)] * count)
    return {"car": car, "period_ms": 1e3 * period_s, "intervals": len(plan), "step_ms": step} | {
        "preparation_ms": prepare,
        "solve_ms": solve,
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=500, help="steps a row (default 500)")
    parser.add_argument("--json", type=Path, help="also write the rows to this file")
    arguments = parser.parse_args()
    rows = [measure(car, period, arguments.count) for car, period in CASES]
    print(f"{'car':8} {'period':>9} {'intervals':>9} {'preparation':>12} {'solve':>9} {'step':>9}")
    for row in rows:
        print(
            f"{row['car']:8} {row['period_ms']:6.0f} ms {row['intervals']:9d} {row['preparation_ms']:9.3f} ms"
            f" {row['solve_ms']:6.3f} ms {row['step_ms']:6.3f} ms"
        )
    if arguments.json:
        write_text(arguments.json, json.dumps(rows, indent=1))


if __name__ == "__main__":
    main()
