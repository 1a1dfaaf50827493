"""Closed-loop simulation speed, as a multiple of real time: `python -m benchmarks.bench_loop`.

Each drive is repeated and the median reported; the first one, which compiles and imports, is left out.
`--profile` splits the CPU time of each drive, which is then written to a folder too, into its parts
(`benchmarks.loop_parts`).
`--against CHECKOUT` drives this version and another one in turn and prints the ratio of their CPU times,
which other load on the machine hardly changes. `--set detection.threads=1 --set detection.backend=openvino`
times other numbers of threads and backends of the detector.
"""

import argparse
import json
import resource
import tempfile
from collections.abc import Sequence
from pathlib import Path
from statistics import median
from time import process_time
from typing import Any

from benchmarks.loop_parts import PARTS, with_sums
from benchmarks.other_checkout import ratios
from benchmarks.part_timers import OTHER, measured
from foreride.files.writing.atomic import write_text
from foreride.scenarios.bound.simulate_case import simulate_case
from foreride.scenarios.cases import Case
from foreride.scenarios.definition.loading import load
from foreride.scenarios.runs import write as run_folder
from foreride.vehicle.clock import RATE_HZ

CASES = (
    ("quarter", "mpc_preview", "oracle", 100),
    ("quarter", "mpc_preview", "oracle", 200),
    ("half", "mpc_preview", "oracle", 100),
    ("half", "mpc_preview", "oracle", 200),
    ("half", "mpc_preview", "boxes", 200),
    ("half", "mpc_preview", "camera", 200),
)
CaseRow = tuple[str, str, str, int]
_ALL = "all"


def case_of(row: CaseRow, fields: Sequence[str]) -> Case:
    """The case of a row of `CASES`, with further scenario fields as for `--set`."""
    vehicle, controller, perception, rate_hz = row
    overrides = [f"vehicle.model={vehicle}", f"control.rate_hz={rate_hz}", *fields]
    return Case(load("hump_flat_30", overrides), controller, perception, 0)


def measure(row: CaseRow, repeats: int, fields: Sequence[str]) -> dict[str, Any]:
    """Median real-time factor and run times of one kind of drive."""
    case = case_of(row, fields)
    runs = [_timed(case) for _ in range(repeats + 1)][1:]
    medians = {name: median(run[name] for run in runs) for name in runs[0]}
    return {"vehicle": row[0], "perception": row[2], "control_hz": row[3]} | medians


def _timed(case: Case) -> dict[str, float]:
    """Run times of one drive, with the real-time factor by CPU time."""
    started = process_time()
    timing = simulate_case(case).timing
    return timing | {"factor_by_cpu": case.scenario.ticks / RATE_HZ / (process_time() - started)}


def profile(row: CaseRow, repeats: int, fields: Sequence[str]) -> dict[str, Any]:
    """Median CPU time of each part of one kind of drive, ms per simulated second, step and camera frame."""
    case, splits = case_of(row, fields), []
    duration_s = case.scenario.ticks / RATE_HZ
    with tempfile.TemporaryDirectory() as folder:
        run_folder.write(simulate_case(case), Path(folder) / "first")
        for number in range(repeats):
            with measured(PARTS) as timers:
                run = simulate_case(case)
                run_folder.write(run, Path(folder) / str(number))
            splits.append(timers.seconds)
    parts = {part: 1e3 * median(split[part] for split in splits) for part in [*PARTS, OTHER]}
    counted = {"second": duration_s, "step": duration_s * row[3]}
    if run.looks:
        counted["frame"] = len(run.looks)
    per = {unit: {part: ms / count for part, ms in parts.items()} for unit, count in counted.items()}
    return {"vehicle": row[0], "perception": row[2], "control_hz": row[3], "ms_per": per}


def print_profile(row: dict[str, Any]) -> None:
    """Print one drive's table of parts; those that took nothing are left out."""
    tables = {unit: with_sums(parts) for unit, parts in row["ms_per"].items()}
    totals = {unit: sum(parts.values()) for unit, parts in row["ms_per"].items()}
    print(f"\n{row['vehicle']} car, {row['perception']}, control {row['control_hz']} Hz: CPU time, ms per")
    print(f"{'':42s}" + "".join(f"{unit:>10s}" for unit in tables) + f"{'share':>8s}")
    second = tables["second"]
    for part in [part for part in second if second[part] >= 5e-4] + [_ALL]:
        values = [totals[unit] if part == _ALL else table[part] for unit, table in tables.items()]
        group, colon, rest = part.partition(":")
        name = f"  {rest}" if colon else group
        numbers = "".join(f"{value:10.3f}" for value in values)
        print(f"{name:42s}{numbers}{100 * values[0] / totals['second']:7.1f} %", flush=True)


def print_speed(row: dict[str, Any]) -> None:
    """Print the speed of one kind of drive."""
    look = f"  look {row['look_median_ms']:.0f} ms" if row["perception"] == "camera" else ""
    print(
        f"{row['vehicle']:8s} {row['perception']:7s} control {row['control_hz']} Hz: "
        f"{row['real_time_factor']:5.1f} x real time, by CPU time {row['factor_by_cpu']:5.1f} x, "
        f"MPC step {row['median_ms']:.2f} ms{look}",
        flush=True,
    )


def main() -> None:
    """Measure, print, and write JSON if requested."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--cases", default="", help="of these words only: half, camera, ...")
    parser.add_argument("--profile", action="store_true", help="CPU time of each part")
    parser.add_argument("--against", type=Path, help="another checkout, driven in turn with this one")
    parser.add_argument("--set", action="append", default=[], metavar="PATH.TO.FIELD=VALUE")
    parser.add_argument("--json", type=Path)
    arguments = parser.parse_args()
    words = arguments.cases.split()
    cases = [row for row in CASES if all(word in map(str, row) for word in words)]
    if arguments.against:
        rows = ratios(arguments.against, cases, arguments.repeats)
    else:
        work, show = (profile, print_profile) if arguments.profile else (measure, print_speed)
        rows = []
        for case in cases:
            rows.append(work(case, arguments.repeats, arguments.set))
            show(rows[-1])
    peak_mib = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(f"peak memory {peak_mib:.0f} MiB")
    if arguments.json:
        write_text(arguments.json, json.dumps({"rows": rows, "peak_mib": peak_mib}, indent=2) + "\n")


if __name__ == "__main__":
    main()
