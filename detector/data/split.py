"""Split of a labelled folder into training, validation and test images: `foreride detector split`.

Pictures taken one after the other show the same road, so whole runs of names are kept together: the first
ones are for training, the next for validation, the last for test.
"""

from collections.abc import Sequence
from pathlib import Path

from foreride.detector.data.yolo_folder import image_paths, read_labels
from foreride.files.command_line import Parser, notify
from foreride.files.errors import InputError
from foreride.files.reading.images import IMAGE_LIMIT
from foreride.files.reading.numbers import within
from foreride.files.reading.regular_file import read_bytes
from foreride.files.writing.folder import Draft, atomic_folder

KIND = "images"
"""Of the folder written, in its marker."""


def split(source: Path, out: Path, val: float, test: float) -> dict[str, int]:
    """Write train/, val/ and, unless its share is 0, test/; return the number of images of each.

    Raises InputError for shares that leave nothing to train on, and for labels that cannot be used.
    """
    within("--val", val, 0.01, 0.9)
    within("--test", test, 0.0, 0.9)
    paths = image_paths(source)
    counts = {"val": max(1, round(val * len(paths))), "test": round(test * len(paths))}
    counts = {"train": len(paths) - sum(counts.values())} | counts
    if counts["train"] < 1:
        raise InputError(
            f"{source}: {len(paths)} images leave none to train on with --val {val:g} --test {test:g}"
        )
    if not (source / "labels").is_dir():
        raise InputError(f"{source}: no folder labels/ in it; a dataset holds images/ and labels/")
    with atomic_folder(out, KIND) as draft:
        start = 0
        for part, count in counts.items():
            for path in paths[start : start + count]:
                _copy(draft, part, path)
            start += count
    return counts


def _copy(draft: Draft, part: str, image: Path) -> None:
    """Copy an image with its label file, and its mask if it has one."""
    source = image.parent.parent
    label, mask = source / "labels" / f"{image.stem}.txt", source / "lane" / f"{image.stem}.png"
    read_labels(label)
    draft.write(f"{part}/images/{image.name}", read_bytes(image, IMAGE_LIMIT))
    draft.write(f"{part}/labels/{label.name}", read_bytes(label) if label.exists() else b"")
    if mask.exists():
        draft.write(f"{part}/lane/{mask.name}", read_bytes(mask, IMAGE_LIMIT))


def main(arguments: Sequence[str] | None = None) -> int:
    """Command line; exit code 0, or 2 on bad input."""
    p = Parser(prog="foreride detector split", description=__doc__)
    p.add_argument("source", type=Path, help="folder with images/ and labels/")
    p.add_argument("out", type=Path, help="folder to write, new or empty")
    p.add_argument("--val", type=float, default=0.2, help="share for validation (default 0.2)")
    p.add_argument("--test", type=float, default=0.0, help="share for test (default 0)")
    options = p.parse_args(arguments)
    try:
        counts = split(options.source, options.out, options.val, options.test)
    except InputError as error:
        notify(error)
        return 2
    print(
        f"{options.out}: "
        + ", ".join(f"{count} images in {part}/" for part, count in counts.items() if count)
    )
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
