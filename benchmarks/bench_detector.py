"""Time of one image through the exported detector: `python -m benchmarks.bench_detector [--json FILE]`.

Rows hold the median and the least of single-image times in milliseconds, from bytes to boxes: network,
threshold and suppression. Thread pools do not spin between images.
"""

import argparse
import json
from pathlib import Path
from time import perf_counter

import numpy as np

from detector.detection import CLASS_NAMES
from detector.runtime import Detector
from files.atomic import write_text

SIZES = ((640, 384), (640, 640), (320, 192))


def time_size(detector: Detector, width: int, height: int, runs: int) -> list[float]:
    """Times of `runs` images (ms), after three to warm up."""
    image = np.random.default_rng(0).integers(0, 256, (height, width, 3), dtype=np.uint8)
    times = []
    for _ in range(runs + 3):
        start = perf_counter()
        detector(image)
        times.append(1e3 * (perf_counter() - start))
    return times[3:]


def measure(threads: list[int], runs: int, weights: Path | None) -> list[dict]:
    rows = []
    for count in threads:
        detector = Detector(weights, threads=count)
        for width, height in SIZES:
            times = time_size(detector, width, height, runs)
            rows.append(
                {
                    "model": "sbp-yolo",
                    "graph": "plain",
                    "precision": "fp32",
                    "backend": "onnxruntime",
                    "size": f"{width}x{height}",
                    "threads": count,
                    "median_ms": float(np.median(times)),
                    "least_ms": min(times),
                    "classes": len(CLASS_NAMES),
                }
            )
    return rows


def main() -> None:
    p = argparse.ArgumentParser(description=__doc__)
    p.add_argument("--threads", default="1,2", help="numbers of threads, comma between")
    p.add_argument("--runs", type=int, default=30)
    p.add_argument("--weights", type=Path)
    p.add_argument("--json", type=Path)
    args = p.parse_args()
    rows = measure([int(t) for t in args.threads.split(",")], args.runs, args.weights)
    for row in rows:
        print(f"{row['size']:8} {row['threads']} threads: {row['median_ms']:.1f} ms ({row['least_ms']:.1f})")
    if args.json:
        write_text(args.json, json.dumps(rows, indent=1) + "\n")


if __name__ == "__main__":
    main()
