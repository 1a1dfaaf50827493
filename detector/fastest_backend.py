"""Fastest installed backend on this machine: measured once, then read from the user's cache.

The choice is kept for each machine, processor, set of library versions, weights and number of threads, as
backends differ in the last digits of their results.
"""

import hashlib
import json
import os
import platform
from collections.abc import Iterable
from contextlib import suppress
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from statistics import median
from time import perf_counter

import numpy as np

from foreride.detector.backends import BACKENDS, CPU, Run, computes_bf16, installed, open_network
from foreride.files.cache import cached
from foreride.files.errors import InputError
from foreride.files.reading.strict_json import read_json
from foreride.files.writing.atomic import write_text

FASTEST = "fastest"
"""Name that stands for the fastest installed backend."""
GAIN = 0.9
"""Largest share of the time of `cpu` for which another backend is preferred to it."""
_WARM_UP, _ROUNDS = 2, 7
_ASPECT = 0.6  # height over width of the measured image
_PACKAGES = ("onnxruntime", "onnxruntime-gpu", "openvino")


def fastest_backend(path: Path, threads: int, width: int) -> str:
    """Name of the backend that runs the network of an ONNX file fastest on images of this width."""
    size = width, round(_ASPECT * width / 32) * 32
    names = [name for name in installed() if BACKENDS[name].arithmetic != "bf16" or computes_bf16()]
    if names == [CPU]:
        return CPU
    file = cached(f"backends/{_key(path, threads, size, names)}.json")
    kept = _kept(file)
    if kept in names:
        return kept
    times_ms = measured(path, names, threads, size)
    best = choice(times_ms)
    with suppress(OSError):  # a choice that cannot be cached still serves this process
        write_text(file, json.dumps({"backend": best, "median_ms": times_ms}, indent=1) + "\n")
    return best


def choice(times_ms: dict[str, float]) -> str:
    """Fastest backend; `cpu` unless another is clearly faster."""
    best = min(times_ms, key=lambda name: times_ms[name])
    return best if CPU not in times_ms or times_ms[best] <= GAIN * times_ms[CPU] else CPU


def measured(path: Path, names: Iterable[str], threads: int, size: tuple[int, int]) -> dict[str, float]:
    """Median run time of the network by backend, timed in turn; backends that cannot run it are left out."""
    image = np.random.default_rng(0).integers(0, 256, (size[1], size[0], 3), dtype=np.uint8)
    networks: dict[str, Run] = {}
    for name in names:
        with suppress(InputError):
            networks[name] = open_network(path, name, threads, size)
            networks[name](image)
    times: dict[str, list[float]] = {name: [] for name in networks}
    for _ in range(_WARM_UP + _ROUNDS):
        for name, run in networks.items():
            start = perf_counter()
            run(image)
            times[name].append(1e3 * (perf_counter() - start))
    return {name: median(values[_WARM_UP:]) for name, values in times.items()}


def _kept(file: Path) -> str | None:
    """Backend of an earlier measurement; None without a readable one."""
    if not file.is_file():
        return None
    try:
        return str(read_json(file)["backend"])
    except (InputError, LookupError, TypeError):
        return None


def _key(path: Path, threads: int, size: tuple[int, int], names: list[str]) -> str:
    weights = hashlib.sha256(path.read_bytes()).hexdigest()
    machine = [platform.node(), platform.machine(), _processor(), os.cpu_count()]
    told = [machine, [_version(name) for name in _PACKAGES], weights, threads, size, names]
    return hashlib.sha256(json.dumps(told).encode()).hexdigest()


def _processor() -> str:
    """Name of the processor's model."""
    with suppress(OSError):
        for line in Path("/proc/cpuinfo").read_text().splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    return platform.processor()


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return ""
