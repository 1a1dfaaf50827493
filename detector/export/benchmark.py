"""Inference benchmark over models, graphs, precisions, backends and threads.

`foreride detector bench --json FILE`: all rows are timed in turn within each round, so that other load on the
machine affects all rows alike. Compare medians of the same run only: wall time, and CPU time over all
threads, which is insensitive to other programs. Times are of the network alone, from uint8 image to candidate
boxes. Models have random weights, which take as long as trained ones, or those of `--weights`.
"""

import argparse
import itertools
import json
import resource
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from time import perf_counter, process_time

import numpy as np
from numpy.typing import NDArray

from foreride.detector.backends import BACKENDS, installed, open_network
from foreride.files.command_line import Parser, notify, output_path
from foreride.files.errors import InputError
from foreride.files.progress import Progress
from foreride.files.reading.numbers import is_integer, within
from foreride.files.writing.atomic import write_text
from foreride.files.writing.targets import check_files

GRAPHS = ("plain", "optimised")
PRECISIONS = ("fp32", "fp16", "int8")
WARM_UP = 3


@dataclass(frozen=True)
class Case:
    """Benchmark case: model, graph and precision, and the backend that runs it."""

    model: str
    graph: str
    precision: str
    backend: str
    size: str
    threads: int


def cases(args: argparse.Namespace) -> list[Case]:
    """All cases of the command line. The plain graph is timed in single precision only."""
    combinations = itertools.product(args.graphs, args.precisions)
    graph_precisions = [(g, p) for g, p in combinations if g == "optimised" or p == "fp32"]
    grid = itertools.product(args.models, graph_precisions, args.backends, args.sizes, args.threads)
    return [Case(m, g, p, b, s, int(t)) for m, (g, p), b, s, t in grid]


def prepare(rows: Sequence[Case], folder: Path, weights: Path | None, data: Path | None) -> dict[Case, Path]:
    """Write the ONNX files of all cases into a folder; needs torch.

    weights: of `detector train`, for cases of its model; random ones for all others. data: folder with
    images/ to calibrate 8-bit graphs on; smooth noise without.
    """
    from foreride.detector.export.to_onnx import CALIBRATION_IMAGES, check_images, export
    from foreride.detector.network.checkpoint import DEFAULT_MODEL

    needs_calibration = any(row.precision == "int8" for row in rows)
    images = check_images(data, CALIBRATION_IMAGES if needs_calibration and data else 4)
    files: dict[tuple[str, str, str], Path] = {}
    for row in rows:
        file_key = (row.model, row.graph, file_precision(row))
        if file_key not in files:
            weights_for_model = weights if row.model == DEFAULT_MODEL else None
            source = weights_for_model or random_weights(row.model, folder)
            files[file_key] = folder / f"{'_'.join(file_key)}.onnx"
            export(source, files[file_key], "bench", images, row.graph == "plain", file_key[2])
    return {row: files[row.model, row.graph, file_precision(row)] for row in rows}


def random_weights(model: str, folder: Path) -> Path:
    """Weights file of an untrained model."""
    import torch

    from foreride.detector.network.checkpoint import save_weights
    from foreride.detector.network.models import build

    torch.manual_seed(0)
    path = folder / f"{model}.pt"
    save_weights(path, build(model), {"model": model})
    return path


def file_precision(row: Case) -> str:
    """Precision for `detector export` that suits the backend: OpenVINO has its own kind of 8-bit graph."""
    openvino = row.backend in BACKENDS and not BACKENDS[row.backend].provider
    return "int8-conv" if row.precision == "int8" and openvino else row.precision


def measure(files: dict[Case, Path], runs: int) -> list[dict]:
    """Timing of every case over `runs` rounds: median and least wall time, and median CPU time, in ms."""
    sessions = []
    for case, path in files.items():
        width, height = _pixels(case.size)
        image = np.random.default_rng(0).integers(0, 256, (height, width, 3), dtype=np.uint8)
        sessions.append((open_network(path, case.backend, case.threads, (width, height)), image))
    times: NDArray[np.float64] = np.empty((runs + WARM_UP, len(sessions), 2))
    with Progress(runs + WARM_UP) as progress:
        for done, row in enumerate(times):
            for i, (run, image) in enumerate(sessions):
                start = perf_counter(), process_time()
                run(image)
                row[i] = 1e3 * (perf_counter() - start[0]), 1e3 * (process_time() - start[1])
            progress.show(done + 1, "timing")
    medians, shortest = np.median(times[WARM_UP:], 0), times[WARM_UP:].min(0)
    return [
        asdict(case)
        | {"median_ms": median[0], "least_ms": shortest_row[0], "median_cpu_ms": median[1], "runs": runs}
        for case, median, shortest_row in zip(files, medians.tolist(), shortest.tolist(), strict=True)
    ]


def peak_memory_mib(weights: Path | None = None, images: int = 5) -> float:
    """Peak resident memory (MiB) of this process after a few images."""
    from foreride.detector.runtime import Detector

    detector = Detector(weights)
    for _ in range(images):
        detector(np.zeros((384, 640, 3), np.uint8))
    return _peak_kib() / 1024


def _peak_kib() -> float:
    """Peak resident memory (KiB) of this program; `getrusage` would include that of its parent."""
    status = Path("/proc/self/status")
    lines = status.read_text().splitlines() if status.exists() else []
    peaks = [float(line.split()[1]) for line in lines if line.startswith("VmHWM:")]
    return peaks[0] if peaks else float(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)


def fresh_peak_memory_mib() -> float:
    """Peak resident memory (MiB) of the detector alone, in a new process."""
    code = "from foreride.detector.export.benchmark import peak_memory_mib; print(peak_memory_mib())"
    completed = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    return float(completed.stdout)


def _pixels(size: str) -> tuple[int, int]:
    try:
        width, height = (int(part) for part in size.split("x"))
    except ValueError:
        width = height = 0
    if min(width, height) < 64 or width % 32 or height % 32:
        raise InputError(f"--sizes: must be WIDTHxHEIGHT, multiples of 32 and >= 64, got {size!r}")
    return width, height


def _words(text: str) -> list[str]:
    return [word for word in text.split(",") if word]


def parser() -> argparse.ArgumentParser:
    """Command line of `detector bench`."""
    p = Parser(prog="foreride detector bench", description=__doc__)
    p.add_argument(
        "--models", type=_words, default=["sbp-yolo", "yolo11n"], help="names of `detector models`"
    )
    p.add_argument("--graphs", type=_words, default=list(GRAPHS), help=", ".join(GRAPHS))
    p.add_argument("--precisions", type=_words, default=["fp32", "int8"], help=", ".join(PRECISIONS))
    p.add_argument("--backends", type=_words, default=["cpu"], help=", ".join(BACKENDS))
    p.add_argument("--sizes", type=_words, default=["640x384"], help="WIDTHxHEIGHT[,...]")
    p.add_argument("--threads", type=_words, default=["1", "2"], help="numbers of threads")
    p.add_argument("--runs", type=int, default=30)
    p.add_argument("--weights", type=Path, help="weights file of sbp-yolo; random ones by default")
    p.add_argument("--data", type=Path, help="folder with images/ for int8 calibration")
    p.add_argument("--memory", action="store_true", help="only the peak memory of the shipped detector (MiB)")
    p.add_argument("--json", type=output_path, help="write the rows here")
    return p


def main(arguments: Sequence[str] | None = None) -> int:
    """Command line; exit code 0, or 2 on bad input."""
    args = parser().parse_args(arguments)
    try:
        check_files(args.json)
        if args.memory:
            rows = [{"model": "shipped", "size": "640x384", "peak_memory_mib": fresh_peak_memory_mib()}]
            print(f"peak memory {rows[0]['peak_memory_mib']:.0f} MiB")
        else:
            rows = compare(args)
    except InputError as error:
        notify(error)
        return 2
    if args.json:
        write_text(args.json, json.dumps(rows, indent=1) + "\n")
    return 0


def check(args: argparse.Namespace) -> None:
    """Check the command line. Raises InputError for unknown names, invalid sizes and counts below 1."""
    for option, allowed in (("graphs", GRAPHS), ("precisions", PRECISIONS), ("backends", tuple(BACKENDS))):
        for word in getattr(args, option):
            if word not in allowed:
                raise InputError(f"--{option}: must be of {', '.join(allowed)}, got {word!r}")
    for size in args.sizes:
        _pixels(size)
    for threads in args.threads:
        if not is_integer(threads) or int(threads) < 1:
            raise InputError(f"--threads: must be whole numbers >= 1, got {threads!r}")
    within("--runs", args.runs, 1, 1_000_000)


def compare(args: argparse.Namespace) -> list[dict]:
    """Time all cases and print them. Raises InputError."""
    check(args)
    for name in args.backends:
        if name not in installed():
            notify(f"backend {name}: left out, it needs {BACKENDS[name].package}")
            args.backends = [b for b in args.backends if b != name]
    requested = cases(args)
    if not requested:
        raise InputError("no case to time: the plain graph is timed in fp32 only")
    with tempfile.TemporaryDirectory() as folder:
        rows = measure(prepare(requested, Path(folder), args.weights, args.data), args.runs)
    for row in rows:
        names = f"{row['model']:12}{row['graph']:11}{row['precision']:6}{row['backend']:14}{row['size']:9}"
        times = f"{row['median_ms']:7.2f} ms (least {row['least_ms']:.2f}, cpu {row['median_cpu_ms']:.2f})"
        print(f"{names}{row['threads']} threads: {times}")
    return rows


if __name__ == "__main__":
    raise SystemExit(main())
