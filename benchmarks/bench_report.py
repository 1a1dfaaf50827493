"""Size and loading time of a run's HTML report in headless Chromium: `python -m benchmarks.bench_report`.

A drive of at least 10 s with the camera is simulated unless a report is given. "Ready" is when replay and
charts are complete, by the browser's own clock from the start of navigation; each time with an empty profile.
"""

import argparse
import json
import re
import shutil
import subprocess
import tempfile
from pathlib import Path
from statistics import median

from foreride.scenarios.bound.simulate_case import simulate_case
from foreride.scenarios.cases import Case
from foreride.scenarios.definition.loading import load
from foreride.scenarios.report.gather import ReportInput
from foreride.scenarios.report.html import page
from foreride.scenarios.runs.write import row

_FLAGS = (
    "--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-sync",
    "--disable-background-networking", "--disable-component-update",
)  # fmt: skip
LONG = {"speed_kmh": 30, "road.length_m": 90}
"""Overrides for a drive of over 10 s."""


def write_report(path: Path) -> float:
    """Write the report of a passive and a camera drive, with images; return the simulated seconds."""
    scenario = load("hump_flat_30", LONG)
    cases = Case(scenario, "passive", "none", 0), Case(scenario, "mpc_preview", "camera", 0)
    runs = tuple(simulate_case(case, keep_images=True) for case in cases)
    path.write_text(page(ReportInput(runs, tuple(row(run) for run in runs))))
    return scenario.ticks / 1000


def ready_ms(chromium: str, report: Path, width: int) -> int:
    """Time from navigation until the report is ready, ms. Raises RuntimeError if it never is."""
    with tempfile.TemporaryDirectory() as profile:
        command = [chromium, *_FLAGS, f"--user-data-dir={profile}", f"--window-size={width},900"]
        dumped = subprocess.run(
            [*command, "--dump-dom", report.resolve().as_uri()], capture_output=True, text=True, timeout=300
        )
    found = re.search(r'<html[^>]*data-ready="(\d+)"', dumped.stdout)
    if not found:
        raise RuntimeError(f"the report never got ready: {dumped.stderr[-300:]}")
    return int(found[1])


def main() -> None:
    """Measure, print, and write JSON if requested."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("report", type=Path, nargs="?", help="default: one of a drive of over 10 s")
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--json", type=Path)
    arguments = parser.parse_args()
    browsers = (shutil.which(name) for name in ("chromium", "chromium-browser", "google-chrome"))
    chromium = next(filter(None, browsers), None)
    if chromium is None:
        raise SystemExit("bench_report needs Chromium on the PATH")
    with tempfile.TemporaryDirectory() as folder:
        report = arguments.report or Path(folder) / "report.html"
        if arguments.report is None:
            print(f"drive of {write_report(report):.1f} s")
        size_mb = report.stat().st_size / 1e6
        print(f"size {size_mb:.1f} MB")
        found = {}
        for width in (1280, 390):
            times = [ready_ms(chromium, report, width) for _ in range(arguments.repeats)]
            found[f"ready_ms_{width}"] = median(times)
            print(f"{width} px wide: ready after {median(times):.0f} ms (median of {sorted(times)})")
    if arguments.json:
        arguments.json.write_text(json.dumps({"size_mb": size_mb} | found, indent=2) + "\n")


if __name__ == "__main__":
    main()
