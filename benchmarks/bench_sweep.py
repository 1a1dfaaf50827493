"""Sweep throughput on one and on two local workers: `python -m benchmarks.bench_sweep [STUDY]`.

For reference, the same run measures how much two compute-bound processes gain on this machine: two threads of
one core, or a busy machine, limit any sweep to that. Minutes for 10 000 drives are extrapolated from the
drives measured.
"""

import argparse
import json
import multiprocessing
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from distributed import Client

from foreride.scenarios.studies.results import Results
from foreride.scenarios.studies.study import Sample, read
from foreride.scenarios.studies.sweep import cluster, run

STUDY = Path("examples/sweep/quarter_car_map.yaml")
MANY = 10_000
WARM = 8


def sweep(samples: Sequence[Sample], workers: int) -> dict[str, float]:
    """Drives per second of wall-clock time and CPU seconds per drive on the workers, without start-up."""
    with tempfile.TemporaryDirectory() as folder, cluster(None, workers) as client:
        results = Results(Path(folder))
        run(client, samples[: WARM * workers], results)
        busy, started = _cpu_s(client), time.perf_counter()
        run(client, samples[WARM * workers :], results)
        wall_s, drives = time.perf_counter() - started, len(samples) - WARM * workers
        failed = sum(error is not None for error in results.done.values())
        return {
            "workers": workers,
            "drives": drives,
            "failed": failed,
            "drives_per_s": drives / wall_s,
            "cpu_s_per_drive": (_cpu_s(client) - busy) / drives,
        }


def _cpu_s(client: Client) -> float:
    return float(sum(client.run(time.process_time).values()))


def compute(seconds: float) -> float:
    """Iterations per second of a loop that uses little memory, measured over about `seconds`."""
    turns, started = 0, time.perf_counter()
    while time.perf_counter() - started < seconds:
        np.sin(_ANGLES).sum()
        sum(range(2000))
        turns += 1
    return turns / (time.perf_counter() - started)


_ANGLES = np.linspace(0.0, 1.0, 2000)


def bare(processes: int, seconds: float = 8.0) -> float:
    """Iterations per second of `processes` processes together."""
    with multiprocessing.get_context("spawn").Pool(processes) as pool:
        pool.map(compute, [0.2] * processes, chunksize=1)
        return sum(pool.map(compute, [seconds] * processes, chunksize=1))


def main() -> None:
    """Measure, print, and write JSON if requested."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("study", type=Path, nargs="?", default=STUDY)
    parser.add_argument("--drives", type=int, default=200, help="to measure, from the study's beginning")
    parser.add_argument("--json", type=Path)
    arguments = parser.parse_args()
    samples = read(arguments.study)[: arguments.drives + 2 * WARM]
    rows = [sweep(samples, workers) for workers in (1, 2)]
    loops = [bare(processes) for processes in (1, 2)]
    for row in rows:
        minutes = MANY / row["drives_per_s"] / 60
        told = f"{row['drives_per_s']:6.2f} drives/s, {row['cpu_s_per_drive']:.3f} CPU s a drive"
        print(
            f"{row['workers']} worker(s): {told}, {row['failed']} failed; {MANY} would take {minutes:.1f} min"
        )
    gain = rows[1]["drives_per_s"] / rows[0]["drives_per_s"]
    print(f"two workers {gain:.2f} x one; two bare processes {loops[1] / loops[0]:.2f} x one")
    if arguments.json:
        found = {"rows": rows, "two_over_one": gain, "bare_two_over_one": loops[1] / loops[0]}
        arguments.json.write_text(json.dumps(found, indent=2) + "\n")


if __name__ == "__main__":
    main()
