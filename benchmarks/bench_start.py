"""CPU time of starting foreride in a fresh interpreter: `python -m benchmarks.bench_start`.

The time is user plus system time of the process, the median of several; the first start, which compiles
bytecode, is left out.
"""

import argparse
import resource
import subprocess
import sys
from statistics import median

_COMMAND = "import sys; from foreride.scenarios.cli import main; sys.exit(main({!r}))"
STARTS = {
    "python": "pass",
    "import foreride": "import foreride",
    "foreride --help": _COMMAND.format(["--help"]),
    "foreride run --help": _COMMAND.format(["run", "--help"]),
}
"""Code of each start by its name; the first is the interpreter alone."""


def cpu_s(code: str) -> float:
    """CPU time of one interpreter that executes the code."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([sys.executable, "-c", code], check=True, stdout=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return (after.ru_utime - before.ru_utime) + (after.ru_stime - before.ru_stime)


def main() -> None:
    """Measure and print a table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repeats", type=int, default=5)
    repeats = parser.parse_args().repeats
    for name, code in STARTS.items():
        print(f"{name:20s} {median([cpu_s(code) for _ in range(repeats + 1)][1:]):.3f} s of CPU")


if __name__ == "__main__":
    main()
