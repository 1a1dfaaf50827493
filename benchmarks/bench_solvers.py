"""Solver comparison on the controllers' programs: `python -m benchmarks.bench_solvers [--json FILE]`.

The programs are those of a car in random states before a wavy road, condensed as in
`foreride.controller.mpc.condensing`; every solver gets the same ones, without warm start. The error is the
largest distance by which a single entry of the solution could still move to reduce the cost, kN·s/m; it is
zero at the optimum. A solver fails if it reports failure, raises, crashes, or exceeds TOLERANCE. IPOPT solves
the same programs as nonlinear ones. Each solver runs in a process of its own; times are processor times, so
that other load on the machine does not count.
"""

import argparse
import json
import multiprocessing
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from pathlib import Path
from time import process_time
from typing import Any, NamedTuple
from unittest.mock import patch

import casadi
import numpy as np

from benchmarks.bench_mpc import random_situations
from foreride.controller.interface import Timing
from foreride.controller.mpc.controller import PredictiveController
from foreride.controller.mpc.qp import Solution, solve_box
from foreride.files.writing.atomic import write_text
from foreride.vehicle.load import load_vehicle

TOLERANCE = 0.01
CASES = (("quarter", 0.01), ("half", 0.01), ("full", 0.01))
QUIET: dict[str, Any] = {"print_time": False, "error_on_fail": False}
CONIC: dict[str, dict[str, Any]] = {
    "daqp": {},
    "qrqp": {"print_iter": False, "print_header": False, "print_info": False},
    "osqp": {"osqp": {"verbose": False}},
    "proxqp": {},
    "ipqp": {"print_iter": False, "print_header": False, "print_info": False},
}


class Program(NamedTuple):
    """Box-constrained quadratic program: ½ xᵀHx + gᵀx with low <= x <= high."""

    hessian: np.ndarray
    gradient: np.ndarray
    low: np.ndarray
    high: np.ndarray


Solve = Callable[[Program], tuple[np.ndarray, str | None]]
"""Returns the solution and the failure, None for success."""


def programs(car: str, period_s: float, count: int) -> list[Program]:
    """Quadratic programs of consecutive steps of the controller."""
    vehicle = load_vehicle(car)
    controller = PredictiveController(vehicle, timing=Timing(period_s))
    found = []

    def noted(*program: Any) -> Solution:
        found.append(Program(*(part.copy() for part in program[:4])))
        return solve_box(*program[:4])

    room = "foreride.controller.mpc.program"
    with patch(f"{room}.solve_stages", lambda *_: None), patch(f"{room}.solve_box", noted):
        for estimate, preview in random_situations(vehicle, count):
            controller.step(estimate, preview)
    return found


def ours(program: Program) -> tuple[np.ndarray, str | None]:
    """foreride's own solver call."""
    return solve_box(program.hessian, program.gradient, program.low, program.high)


def conic(name: str, size: int) -> Solve:
    """CasADi `conic` plug-in without general constraints."""
    shape = {"h": casadi.Sparsity.dense(size, size), "a": casadi.Sparsity(0, size)}
    solver = casadi.conic("solver", name, shape, QUIET | CONIC[name])

    def solve(program: Program) -> tuple[np.ndarray, str | None]:
        answer = solver(h=program.hessian, g=program.gradient, lbx=program.low, ubx=program.high)
        stats = solver.stats()
        wrong = None if stats["success"] else str(stats.get("unified_return_status", "failed"))
        return np.array(answer["x"])[:, 0], wrong

    return solve


def hpipm(size: int) -> Solve:
    """HPIPM through CasADi, which accepts optimal control problems only.

    All commands form one stage, followed by a state that none of them affects: without a state it crashes.
    """
    block = casadi.diagcat(casadi.Sparsity.dense(size, size), casadi.Sparsity.dense(1, 1))
    shape = {"h": block, "a": casadi.Sparsity.dense(1, size + 1)}
    stages: dict[str, Any] = {"N": 1, "nx": [0, 1], "nu": [size, 0], "ng": [0, 0]}
    solver = casadi.conic("solver", "hpipm", shape, QUIET | stages)
    still = np.zeros((1, size + 1))
    still[0, -1] = -1.0

    def solve(program: Program) -> tuple[np.ndarray, str | None]:
        hessian = casadi.diagcat(program.hessian, 1.0)
        low, high = np.append(program.low, -1.0), np.append(program.high, 1.0)
        given: dict[str, Any] = {"h": hessian, "g": np.append(program.gradient, 0.0), "a": still}
        answer = solver(**given, lba=0.0, uba=0.0, lbx=low, ubx=high)
        wrong = None if solver.stats()["success"] else str(solver.stats().get("return_status", "failed"))
        return np.array(answer["x"])[:-1, 0], wrong

    return solve


def ipopt(size: int) -> Solve:
    """Interior-point method for nonlinear programs."""
    x, h, g = casadi.MX.sym("x", size), casadi.MX.sym("h", size, size), casadi.MX.sym("g", size)
    cost = 0.5 * casadi.bilin(h, x, x) + casadi.dot(g, x)
    options: dict[str, Any] = QUIET | {"ipopt": {"print_level": 0, "sb": "yes", "tol": 1e-8}}
    problem: dict[str, Any] = {"x": x, "p": casadi.veccat(h, g), "f": cost}
    solver = casadi.nlpsol("solver", "ipopt", problem, options)

    def solve(program: Program) -> tuple[np.ndarray, str | None]:
        given = np.concatenate([program.hessian.ravel(order="F"), program.gradient])
        answer = solver(x0=np.zeros(size), p=given, lbx=program.low, ubx=program.high)
        stats = solver.stats()
        return np.array(answer["x"])[:, 0], None if stats["success"] else stats["return_status"]

    return solve


def error(x: np.ndarray, program: Program) -> float:
    """Largest distance by which an entry could still move on its own to reduce the cost."""
    wished = x - (program.hessian @ x + program.gradient) / np.diag(program.hessian)
    return float(np.abs(np.clip(wished, program.low, program.high) - x).max())


def measure(name: str, given: list[Program]) -> dict:
    """Row of one solver: median and 99th percentile in ms, largest error, failures with the first reason."""
    size = len(given[0].gradient)
    times, errors, failures = [], [], []
    own: dict[str, Callable[[int], Solve]] = {"ours": lambda size: ours, "hpipm": hpipm, "ipopt": ipopt}
    solve = own[name](size) if name in own else conic(name, size)
    for program in given:
        start = process_time()
        answer, wrong = solve(program)
        times.append(1e3 * (process_time() - start))
        errors.append(error(answer, program))
        if wrong or not errors[-1] <= TOLERANCE:
            failures.append(wrong or f"off by {errors[-1]:.2g} kN·s/m")
    return {
        "solver": name,
        "median_ms": float(np.median(times)),
        "p99_ms": float(np.percentile(times, 99)),
        "largest_error": max(errors),
        "failures": len(failures),
        "of": len(given),
        "reason": failures[0] if failures else None,
    }


def measure_in_process(name: str, given: list[Program]) -> dict:
    """Run `measure` in a process of its own, so that a crash counts as one solver's failure."""
    method = "fork" if "fork" in multiprocessing.get_all_start_methods() else "spawn"
    with ProcessPoolExecutor(1, mp_context=multiprocessing.get_context(method)) as pool:
        try:
            return pool.submit(measure, name, given).result()
        except BrokenProcessPool:
            reason = "crashed"
        except Exception as raised:  # plug-ins raise any exception
            reason = f"{type(raised).__name__}: {raised}".splitlines()[0][:80]
    return {"solver": name, "failures": len(given), "of": len(given), "reason": reason}


def main() -> None:
    """Measure, print a table, and write JSON if requested."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=200, help="programs per car (default 200)")
    parser.add_argument("--json", type=Path, help="also write the rows to this file")
    arguments = parser.parse_args()
    rows = []
    print(f"{'car':8} {'size':>5} {'solver':8} {'median':>10} {'p99':>10} {'error':>9} failures")
    for car, period_s in CASES:
        given = programs(car, period_s, arguments.count)
        for name in ("ours", *CONIC, "hpipm", "ipopt"):
            row = {"car": car, "size": len(given[0].gradient)} | measure_in_process(name, given)
            rows.append(row)
            times = [f"{row[key]:7.3f} ms" if key in row else 10 * " " for key in ("median_ms", "p99_ms")]
            off = f"{row['largest_error']:9.1e}" if "largest_error" in row else 9 * " "
            failed = f"{row['failures']} of {row['of']}: {row['reason']}" if row["failures"] else "none"
            print(f"{car:8} {row['size']:5d} {name:8} {' '.join(times)} {off} {failed}", flush=True)
    if arguments.json:
        write_text(arguments.json, json.dumps(rows, indent=1))


if __name__ == "__main__":
    main()
