"""Closed-loop simulation speed, as a multiple of real time: `python -m benchmarks.bench_loop`.

Each drive is repeated and the median reported; the first one, which compiles, is left out.
"""

import argparse
import json
import resource
from pathlib import Path
from statistics import median

from foreride.files.writing.atomic import write_text
from foreride.scenarios.bound.simulate_case import simulate_case
from foreride.scenarios.cases import Case
from foreride.scenarios.definition.loading import load

CASES = (
    ("quarter", "mpc_preview", "oracle", 100),
    ("quarter", "mpc_preview", "oracle", 200),
    ("half", "mpc_preview", "oracle", 100),
    ("half", "mpc_preview", "oracle", 200),
    ("half", "mpc_preview", "boxes", 200),
    ("half", "mpc_preview", "camera", 200),
)


def measure(vehicle: str, controller: str, perception: str, rate_hz: int, repeats: int) -> dict:
    """Median real-time factor and run times of one kind of drive."""
    overrides = {"vehicle.model": vehicle, "control.rate_hz": rate_hz}
    case = Case(load("hump_flat_30", overrides), controller, perception, 0)
    runs = [simulate_case(case).timing for _ in range(repeats + 1)][1:]
    medians = {name: median(run[name] for run in runs) for name in runs[0]}
    return {"vehicle": vehicle, "perception": perception, "control_hz": rate_hz} | medians


def main() -> None:
    """Measure, print a table, and write JSON if requested."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--json", type=Path)
    arguments = parser.parse_args()
    rows = [measure(*case, arguments.repeats) for case in CASES]
    for row in rows:
        look = f"  look {row['look_median_ms']:.0f} ms" if row["perception"] == "camera" else ""
        print(
            f"{row['vehicle']:8s} {row['perception']:7s} control {row['control_hz']} Hz: "
            f"{row['real_time_factor']:5.1f} x real time, MPC step {row['median_ms']:.2f} ms{look}"
        )
    peak_mib = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(f"peak memory {peak_mib:.0f} MiB")
    if arguments.json:
        write_text(arguments.json, json.dumps({"rows": rows, "peak_mib": peak_mib}, indent=2) + "\n")


if __name__ == "__main__":
    main()
