"""Run time of the predictive controllers' step, by part: `python -m benchmarks.bench_mpc [--json FILE]`.

Each row is a car and a control period with the default horizon; times are median and 99th percentile of
processor time, each part measured inside the controller's own step.
"""

import argparse
import json
from array import array
from pathlib import Path
from time import process_time
from typing import Any
from unittest.mock import patch

import numpy as np

from foreride.controller.interface import Estimate, Timing
from foreride.controller.mpc.controller import PredictiveController
from foreride.controller.mpc.qp import solve_box
from foreride.controller.mpc.riccati import solve_stages
from foreride.files.writing.atomic import write_text
from foreride.preview.road_preview import RoadPreview, distance_grid
from foreride.vehicle.equations import rest_state
from foreride.vehicle.load import Car, load_vehicle

CASES = [("quarter", 0.01), ("quarter", 0.005), ("half", 0.01), ("half", 0.005), ("full", 0.01)]
SPEED_M_S = 10.0


def random_situations(vehicle: Car, count: int, seed: int = 0) -> list[tuple[Estimate, RoadPreview]]:
    """Random states of a car before a wavy road, with previews."""
    rng = np.random.default_rng(seed)
    grid, rest = distance_grid(0.5, 10.0), rest_state(vehicle)
    ones, zero = np.ones((vehicle.wheels, len(grid))), np.zeros(vehicle.wheels)
    pairs = []
    for _ in range(count):
        x = rest + np.where(rest > 0, 0.0, 0.1) * rng.standard_normal(len(rest))
        preview = RoadPreview(0.0, grid, 0.05 * ones * np.sin(2 * grid), 0 * ones, 0 * ones, ones)
        pairs.append((Estimate(0.0, x, zero, zero, SPEED_M_S, np.ones(vehicle.wheels, dtype=bool)), preview))
    return pairs


class TimedCall:
    """Callable wrapper that records the processor time of each call, s."""

    def __init__(self, inner: Any):
        self._inner, self._times = inner, array("d")

    def __call__(self, *given: Any) -> Any:
        start = process_time()
        answer = self._inner(*given)
        self._times.append(process_time() - start)
        return answer

    def taken(self) -> "array[float]":
        """Times of the calls since this was asked last."""
        times, self._times = self._times, array("d")
        return times


def measure(car: str, period_s: float, count: int) -> dict[str, Any]:
    """One row: the whole step, and within it preparation (linearisation) and the quadratic program."""
    vehicle = load_vehicle(car)
    controller = PredictiveController(vehicle, timing=Timing(period_s))
    prepare, solve, step = (
        TimedCall(controller._program.condense.along),
        TimedCall(solve_stages),
        TimedCall(controller.step),
    )
    controller._program.condense.along = prepare  # type: ignore[method-assign, assignment]
    # A plan whose bounds do not settle is condensed after that, and solved by another method.
    general = TimedCall(solve_box)
    room, parts = "foreride.controller.mpc.program", array("d")
    with patch(f"{room}.solve_stages", solve), patch(f"{room}.solve_box", general):
        for pair in random_situations(vehicle, count):
            step(*pair)
            parts.extend(sum(part.taken()) for part in (prepare, solve, general))
    row: dict[str, Any] = {"car": car, "period_ms": 1e3 * period_s, "intervals": len(controller._plan)}
    prepared, *solved = np.array(parts).reshape(-1, 3).T
    for name, times in (
        ("prepare", prepared),
        ("solve", sum(solved)),
        ("both", prepared + sum(solved)),
        ("step", step.taken()),
    ):
        ms = 1e3 * np.array(times)[count // 10 :]  # the first ones are warm-up
        row |= {f"{name}_median_ms": float(np.median(ms)), f"{name}_p99_ms": float(np.percentile(ms, 99))}
    return row


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=500, help="steps per row (default 500)")
    parser.add_argument("--json", type=Path, help="also write the rows to this file")
    arguments = parser.parse_args()
    rows = [measure(car, period, arguments.count) for car, period in CASES]
    parts = ("prepare", "solve", "both", "step")
    heads = "".join(f"{name + ', ms':>18}" for name in parts)
    print(f"{'car':8} {'period':>7} {'intervals':>9}{heads}    (median / 99th percentile)")
    for row in rows:
        times = "".join(f"{row[f'{n}_median_ms']:9.3f} / {row[f'{n}_p99_ms']:6.3f}" for n in parts)
        print(f"{row['car']:8} {row['period_ms']:4.0f} ms {row['intervals']:9d}{times}")
    if arguments.json:
        write_text(arguments.json, json.dumps(rows, indent=1))


if __name__ == "__main__":
    main()
