"""CPU times of drives by this checkout and another one, in turn; run as a script it times one checkout."""

import json
import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from statistics import median
from time import process_time
from typing import Any

HERE = Path(__file__).resolve().parents[1]


def ratios(other: Path, cases: Sequence[tuple[str, str, str, int]], repeats: int) -> list[dict[str, Any]]:
    """Print and return, for each case, the median CPU time of a drive by either checkout, and their ratio."""
    rows = []
    for case in cases:
        times: dict[Path, list[float]] = {other.resolve(): [], HERE: []}
        for _ in range(repeats):
            for checkout, found in times.items():
                found.append(_in_process(checkout, case))
        before_s, after_s = (median(found) for found in times.values())
        vehicle, _, perception, rate_hz = case
        row = {"vehicle": vehicle, "perception": perception, "control_hz": rate_hz}
        rows.append(row | {"other_s": before_s, "this_s": after_s, "ratio": before_s / after_s})
        print(
            f"{vehicle:8s} {perception:7s} control {rate_hz} Hz: the other {before_s:7.3f} s of CPU, "
            f"this {after_s:7.3f} s, {before_s / after_s:5.2f} times as fast",
            flush=True,
        )
    return rows


def _in_process(checkout: Path, case: Sequence[Any]) -> float:
    """CPU time of a drive by this checkout, in a process of its own."""
    environment = os.environ | {"PYTHONPATH": str(checkout)}
    command = [sys.executable, __file__, json.dumps(case)]
    done = subprocess.run(command, cwd=checkout, env=environment, check=True, stdout=subprocess.PIPE)
    return float(done.stdout.split()[-1])


def _drive_s(vehicle: str, controller: str, perception: str, rate_hz: int) -> float:
    """CPU time of the best of two drives after one that compiles, by the checkout on the path."""
    sys.path[0] = os.getcwd()
    from benchmarks import bench_loop  # of the checkout

    bench: Any = bench_loop
    overrides: Any = {"vehicle.model": vehicle, "control.rate_hz": rate_hz}
    if not hasattr(bench, "simulate_case"):  # before the package had one name
        overrides = [f"{key}={value}" for key, value in overrides.items()]
    simulate = getattr(bench, "simulate_case", None) or bench.simulate
    case, times = bench.Case(bench.load("hump_flat_30", overrides), controller, perception, 0), []
    for _ in range(3):
        started = process_time()
        simulate(case)
        times.append(process_time() - started)
    return min(times[1:])


if __name__ == "__main__":
    print(_drive_s(*json.loads(sys.argv[1])))
