"""CPU time and memory of starting foreride in a fresh interpreter: `python -m benchmarks.bench_start`.

The time is user plus system time of the process, the median of several; the first start, which compiles
bytecode and machine code, is left out. The memory is the process's greatest resident set so far.
"""

import argparse
import os
import resource
import subprocess
import sys
from statistics import median

_COMMAND = "import sys; from foreride.scenarios.cli import main; sys.exit(main({!r}))"
_FIRST_TICK = """
import sys
from foreride.scenarios import cli

def started(name, parser=cli.parser):
    configured = parser(name)
    from foreride.scenarios.comparison import parallel  # which is imported by now
    from foreride.scenarios.simulation.simulate import simulate
    parallel.simulate_case = lambda case, *_: simulate(case, advance=lambda ticks: sys.exit())
    return configured

cli.parser = started
cli.main(["run", "bump_8x40_30", "--vehicle", "half", "--perception", {!r}])
"""
_PEAK = """
import atexit, resource
atexit.register(lambda: print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss))
"""
STARTS = {
    "python": "pass",
    "import foreride": "import foreride",
    "foreride --help": _COMMAND.format(["--help"]),
    "foreride run --help": _COMMAND.format(["run", "--help"]),
    "first tick, oracle": _FIRST_TICK.format("oracle"),
    "first tick, camera": _FIRST_TICK.format("camera"),
}
"""Code of each start by its name; the first is the interpreter alone."""


def started(code: str) -> tuple[float, float]:
    """CPU time, s, and greatest resident set, MiB, of one interpreter that executes the code."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    command = [sys.executable, "-c", f"{_PEAK}\n{code}"]
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    told = subprocess.run(command, check=True, stdout=subprocess.PIPE, env=environment).stdout
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    spent_s = (after.ru_utime - before.ru_utime) + (after.ru_stime - before.ru_stime)
    return spent_s, int(told.split()[-1]) / 1024


def main() -> None:
    """Measure and print a table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repeats", type=int, default=5)
    repeats = parser.parse_args().repeats
    for name, code in STARTS.items():
        starts = [started(code) for _ in range(repeats + 1)][1:]
        spent_s, peak_mib = (median(values) for values in zip(*starts, strict=True))
        print(f"{name:20s} {spent_s:.3f} s of CPU, {peak_mib:4.0f} MiB", flush=True)


if __name__ == "__main__":
    main()
