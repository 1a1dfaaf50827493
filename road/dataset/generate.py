"""Generation of seeded, labelled image sets in YOLO layout: `foreride detector data --out DIR`."""

import hashlib
import json
import sys
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from pathlib import Path

from rich.console import Console
from rich.progress import Progress

from foreride.files.command_line import Parser, notify
from foreride.files.errors import InputError
from foreride.files.reading.numbers import within
from foreride.files.writing.atomic import write_text
from foreride.files.writing.folder import claim
from foreride.road.dataset.dataset_card import real_statistics, write_card
from foreride.road.dataset.label_views import SPLITS, VIEWS_PER_ROAD, Job, render_road
from foreride.road.obstacle_classes import CLASS_NAMES
from foreride.road.render.visible_boxes import MIN_BOX_HEIGHT_PX, MIN_BOX_WIDTH_PX, MIN_VISIBLE_PX

FORMAT = 1
KIND = "dataset"
"""Of folders of rendered sets, in their marker."""
_ORDER = ("val", "train", "test")  # so that training may begin on a set that still grows
_REPORT_EVERY = 120


def write_dataset(
    out: Path,
    counts: dict[str, int],
    seed: int,
    workers: int = 1,
    report: Callable[[int], None] = lambda done: None,
    approach: bool = False,
    plain: bool = False,
    near: bool = False,
) -> dict:
    """Render `counts[split]` images per split into `out` and return the content of dataset.json.

    Roads are never shared between splits. Every image and label depends only on the seed and its place in the
    set, so the number of workers is immaterial; labels appear before their images, each in one step. `report`
    is called with the number of finished images after each road. With `approach` the views of a road are
    those of a car that drives towards a feature, from 18 m to 3 m, mostly with the default camera. With
    `plain` no road has a bump or a pothole, but many distractors: patches, covers, stains, crossings. With
    `near` cameras are held a few steps before a pothole or a bump and aim at it, and many potholes are large.

    Raises InputError for negative counts or an `out` that already holds a data set.
    """
    for split, count in counts.items():
        if split not in SPLITS or count < 0:
            raise InputError(f"counts must map {', '.join(SPLITS)} to numbers >= 0, got {split}: {count}")
    within("images in all", sum(counts.values()), 0, 10_000_000)
    within("seed", seed, 0, 2**32 - 1)
    within("workers", workers, 1, 1024)
    if (out / "dataset.json").exists():
        raise InputError(f"{out}: already holds a data set; choose an empty folder")
    claim(out, KIND)
    digest, done = hashlib.sha256(), 0
    for split in _ORDER:
        lines = []
        for rows in _run(_jobs(out, split, counts.get(split, 0), seed, approach, plain, near), workers):
            for row in rows:
                digest.update(f"{split}/{row['image']} {row.pop('sha256')}\n".encode())
                lines.append(json.dumps(row) + "\n")
            done += len(rows)
            report(done)
        (out / split).mkdir(parents=True, exist_ok=True)
        write_text(out / split / "objects.jsonl", "".join(lines))
    summary = {
        "format": FORMAT,
        "names": list(CLASS_NAMES),
        "counts": {split: counts.get(split, 0) for split in SPLITS},
        "seed": seed,
        "views_per_road": VIEWS_PER_ROAD,
        "approach": approach,
        "plain": plain,
        "near": near,
        "label_minimum": {
            "height_px": MIN_BOX_HEIGHT_PX,
            "width_px": MIN_BOX_WIDTH_PX,
            "pixels": MIN_VISIBLE_PX,
        },
        "hash": digest.hexdigest(),
    }
    write_text(out / "dataset.json", json.dumps(summary, indent=1) + "\n")
    write_card(out, real_statistics([]))
    return summary


def _jobs(out: Path, split: str, count: int, seed: int, *kinds: bool) -> Iterator[Job]:
    for road, first in enumerate(range(0, count, VIEWS_PER_ROAD)):
        views = min(VIEWS_PER_ROAD, count - first)
        yield Job(out / split, SPLITS.index(split), road, views, seed, *kinds)


def _run(jobs: Iterator[Job], workers: int) -> Iterator[list[dict]]:
    if workers <= 1:
        yield from map(render_road, jobs)
        return
    with ProcessPoolExecutor(workers) as pool:
        yield from pool.map(render_road, jobs)


@contextmanager
def progress(total: int) -> Iterator[Callable[[int], None]]:
    """Progress of rendering: a bar with the time left on a terminal, elsewhere a line at intervals."""
    start_s, last_reported = time.monotonic(), 0

    def print_progress(done: int) -> None:
        nonlocal last_reported
        if done - last_reported >= _REPORT_EVERY or done == total:
            last_reported = done
            print(f"{done}/{total} images, {time.monotonic() - start_s:.0f} s", flush=True)

    if not sys.stderr.isatty():
        yield print_progress
        return
    with Progress(*Progress.get_default_columns(), console=Console(stderr=True)) as bar:
        task = bar.add_task("rendering", total=total)
        yield lambda done: bar.update(task, completed=done)


def main(arguments: list[str] | None = None) -> int:
    """Command line; exit code 0, or 2 on bad input."""
    parser = Parser(prog="foreride detector data", description="Render a labelled data set.")
    parser.add_argument("--out", type=Path, required=True, help="folder to write, empty or new")
    parser.add_argument("--seed", type=int, default=0)
    for split, default in zip(SPLITS, (5250, 1125, 1125), strict=True):
        parser.add_argument(f"--{split}", type=int, default=default, help=f"images (default {default})")
    parser.add_argument(
        "--approach", action="store_true", help="views from a car that drives towards a bump or pothole"
    )
    parser.add_argument(
        "--plain", action="store_true", help="no bump or pothole, but many distractors (patches, covers)"
    )
    parser.add_argument(
        "--near", action="store_true", help="views from a few steps, as photographs of a pothole or bump"
    )
    parser.add_argument("--workers", type=int, default=1, help="processes (default 1)")
    options = parser.parse_args(arguments)
    counts = {split: getattr(options, split) for split in SPLITS}
    try:
        with progress(sum(counts.values())) as report:
            summary = write_dataset(
                options.out,
                counts,
                options.seed,
                options.workers,
                report,
                options.approach,
                options.plain,
                options.near,
            )
    except InputError as error:
        notify(error)
        return 2
    print(f"{options.out}: {sum(counts.values())} images, hash {summary['hash'][:16]}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
