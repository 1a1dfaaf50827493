"""Drives without end in one process: does memory grow? `python -m tests.robustness.soak --minutes
60`.
"""

import argparse
import gc
import os
import random
import sys
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from foreride.files.errors import InputError
from foreride.scenarios.cases import Case
from foreride.scenarios.definition.loading import load
from foreride.scenarios.simulation.simulate import simulate

CONTROLLERS = ("passive", "skyhook", "pdd", "lqr_clipped", "mpc_reactive", "mpc_wheelbase", "mpc_preview")
PERCEPTIONS = ("none", "oracle", "boxes", "camera")
CARS = ("quarter", "half", "full", "suv", "compact_car")
EVENTS = ("bump_8x40_30", "hump_flat_30", "pothole_60x8_40", "rough_c_60", "mixed_40")


@dataclass(frozen=True)
class Sample:
    """Resources of the process after so many drives."""

    minutes: float
    drives: int
    rss_mib: float
    descriptors: int
    threads: int


def drive(rng: random.Random) -> Case:
    """One short drive of a new car with a new camera on a new road."""
    length = rng.uniform(16, 22)
    width = 32 * rng.randrange(4, 12)
    overrides = [
        f"vehicle.model={rng.choice(CARS)}", f"road.length_m={length}", f"speed_kmh={rng.uniform(40, 90)}",
        "road.features=[]", f"road.roughness.iso_class={rng.choice('ABC')}",
        f"road.roughness.seed={rng.randrange(2**31)}", f"camera.intrinsics.width_px={width}",
        f"camera.intrinsics.height_px={32 * rng.randrange(3, 8)}", f"camera.height_m={rng.uniform(1, 1.6)}",
        f"camera.latency_s={rng.uniform(0.01, 0.2)}",
    ]  # fmt: skip
    controller, seed = rng.choice(CONTROLLERS), rng.randrange(2**31)
    sees = controller == "mpc_preview"
    perception = rng.choices(PERCEPTIONS, (1, 3, 3, 1))[0] if sees else "none"
    case = Case(load(rng.choice(EVENTS), overrides), controller, perception, seed)
    with suppress(InputError):  # not every controller fits every car
        simulate(case)
    return case


def soak(seconds: float, seed: int, every_s: float, tell: Callable[[Sample], None]) -> list[Sample]:
    """Drive for so long; what the process held at intervals."""
    rng, samples, drives = random.Random(seed), [], 0
    began = told = time.monotonic()
    while (now := time.monotonic()) - began < seconds or not samples:
        drive(rng)
        drives += 1
        if now - told >= every_s or not samples:
            told = now
            gc.collect()
            samples.append(held((now - began) / 60, drives))
            tell(samples[-1])
    return samples


def held(minutes: float, drives: int) -> Sample:
    """What this process holds now."""
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    rss = pages * os.sysconf("SC_PAGE_SIZE") / 2**20
    return Sample(minutes, drives, rss, len(os.listdir("/proc/self/fd")), threading.active_count())


def growth(samples: list[Sample]) -> float:
    """Slope of memory over the second half, MiB per 1000 drives."""
    late = samples[len(samples) // 2 :]
    if len(late) < 2:
        return 0.0
    drives, rss = np.array([(one.drives, one.rss_mib) for one in late]).T
    return float(1000 * np.polyfit(drives, rss, 1)[0])


def main() -> int:
    """Soak and print the curve."""
    parser = argparse.ArgumentParser(prog="python -m tests.robustness.soak", description=__doc__)
    parser.add_argument("--minutes", type=float, default=60.0)
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()

    def tell(one: Sample) -> None:
        told = f"{one.rss_mib:8.1f} MiB  {one.descriptors:4} descriptors  {one.threads:3} threads"
        print(f"{one.minutes:6.1f} min  {one.drives:6} drives  {told}", flush=True)

    samples = soak(60 * arguments.minutes, arguments.seed, 60.0, tell)
    print(f"second half: {growth(samples):+.2f} MiB per 1000 drives; {samples[-1].drives} drives")
    return 0


if __name__ == "__main__":
    sys.exit(main())
