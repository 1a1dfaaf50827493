"""Tables 1 and 3 of arXiv 2508.01339 on a folder of images: model ablation, distillation; and NWD.

`python -m benchmarks.paper.ladder --table 1|3|nwd|all --data DIR --out FOLDER --passes 60000 [--json FILE]`

Every row is trained for the same number of images, at the same size, on the same images, with the same seed,
and then validated on DIR/val; finished rows are read from their run folders, so an interrupted run can be
restarted. `--table all` trains rows of equal options, such as the student and SBP-YOLO without NWD, once.
With `--seeds 0,1,2` a row is the mean of several trainings, each in a folder of its own. The whole ladder in
ten minutes of one GPU: `--table all --size 320x192 --passes 100000 --batch 256 --rate 4e-3`.
"""

import argparse
import json
import time
from collections.abc import Sequence
from itertools import product
from pathlib import Path

import numpy as np

from benchmarks.command import command
from benchmarks.paper.training import check_same_settings, settings_of, train_ours
from foreride.detector.evaluation.plots import read_history
from foreride.detector.network.complexity import parameters
from foreride.detector.network.models import build
from foreride.detector.training.schedule import Stage, parse_stages
from foreride.files.writing.atomic import write_text
from foreride.scenarios.tables.options import parse_words

LADDER = {
    "yolo11n": ["--model", "yolo11n"],
    "+p2": ["--model", "+p2"],
    "+ledh": ["--model", "+ledh"],
    "+ghost": ["--model", "+ghost"],
    "+vovgscspc": ["--model", "+vovgscspc"],
    "+nwd": ["--model", "sbp-yolo", "--nwd-alpha", "0.5"],
}
DISTILLATION = {
    "teacher": ["--model", "sbp-yolo-s"],
    "student": ["--model", "sbp-yolo"],
    "+bckd": ["--model", "sbp-yolo", "--distil-features", "0"],
    "+cwd": ["--model", "sbp-yolo", "--distil-logits", "0"],
    "+bckd+cwd": ["--model", "sbp-yolo"],
}
NWD = {  # the two constants of eq. 9 and 10: weight of CIoU alpha, and C in strides
    "ciou": ["--model", "sbp-yolo"],
    "alpha 0.75": ["--model", "sbp-yolo", "--nwd-alpha", "0.75"],
    "alpha 0.5": ["--model", "sbp-yolo", "--nwd-alpha", "0.5"],
    "alpha 0.25": ["--model", "sbp-yolo", "--nwd-alpha", "0.25"],
    "nwd": ["--model", "sbp-yolo", "--nwd-alpha", "0"],
    "C 3.2": ["--model", "sbp-yolo", "--nwd-alpha", "0.5", "--nwd-scale", "3.2"],
    "C 6.4": ["--model", "sbp-yolo", "--nwd-alpha", "0.5", "--nwd-scale", "6.4"],
    "C 25.6": ["--model", "sbp-yolo", "--nwd-alpha", "0.5", "--nwd-scale", "25.6"],
}
TABLES = {"1": LADDER, "3": DISTILLATION, "nwd": NWD}
_TAUGHT = ("+bckd", "+cwd", "+bckd+cwd")
_SAME = {"student": "+vovgscspc", "ciou": "+vovgscspc", "alpha 0.5": "+nwd"}
"""Rows that another row of `--table all` is, with equal options."""
ALL = {name: row for table in TABLES.values() for name, row in table.items() if name not in _SAME}


def row(name: str, options: list[str], stage: Stage, args: argparse.Namespace) -> dict:
    """Train one row, unless its run folders are complete, and return its mean numbers. Raises InputError."""
    found = [_trained(name, options, stage, args, seed) for seed in args.seeds]
    kept = ("map50", "map50_95", "precision", "recall")
    means = {key: float(np.mean([one[key] or 0.0 for one in found])) for key in kept}
    spread = {"map50_sigma": float(np.std([one["map50"] or 0.0 for one in found]))}
    told = {"row": name, "parameters": parameters(build(options[1])), "seeds": args.seeds}
    return told | {key: found[0][key] for key in ("passes", "size")} | means | spread


def _trained(name: str, options: list[str], stage: Stage, args: argparse.Namespace, seed: int) -> dict:
    """Last line of the history of one training, which is run or resumed if need be. Raises InputError."""
    one = argparse.Namespace(**vars(args) | {"seed": seed})
    run = folder(args, name, seed)
    teacher = ["--teacher", folder(args, "teacher", seed) / "weights.pt"] if name in _TAUGHT else []
    train_ours(run, stage, one, *options, *teacher, "--rate", args.rate)
    return read_history(run / "history.jsonl")[-1]


def folder(args: argparse.Namespace, name: str, seed: int) -> Path:
    """Run folder of a row; those of further seeds have them in their names."""
    return args.out / (name if seed == args.seeds[0] else f"{name} seed {seed}")


def _seeds(text: str) -> list[int]:
    return [int(word) for word in text.split(",")]


@command
def main(arguments: Sequence[str] | None = None) -> None:
    p = argparse.ArgumentParser(description=__doc__)
    p.add_argument("--table", choices=[*TABLES, "all"], required=True)
    p.add_argument("--data", type=Path, required=True, help="folder with train/ and val/")
    p.add_argument("--out", type=Path, required=True, help="folder for the run folders of the rows")
    p.add_argument("--passes", type=int, default=60000, help="image passes of every row")
    p.add_argument("--size", default="640x384")
    p.add_argument("--batch", type=int, default=16)
    p.add_argument("--rate", type=float, default=2e-3, help="peak learning rate")
    p.add_argument("--seeds", "--seed", type=_seeds, default=[0], metavar="N,...", help="of the trainings")
    p.add_argument("--threads", type=int, default=2)
    p.add_argument("--rows", help="names of rows, separated by commas (default all)")
    p.add_argument("--json", type=Path)
    args = p.parse_args(arguments)
    table = ALL if args.table == "all" else TABLES[args.table]
    names = parse_words("--rows", args.rows, list(table)) if args.rows else list(table)
    (stage,) = parse_stages(f"{args.size}:{args.passes}")
    for name, seed in product(names, args.seeds):
        one = argparse.Namespace(**vars(args) | {"seed": seed})
        check_same_settings(folder(args, name, seed), settings_of(stage, one))
    rows = []
    for name in names:
        begun = time.monotonic()
        rows.append(row(name, table[name], stage, args))
        rows[-1]["seconds"] = round(time.monotonic() - begun, 1)  # of this call: next to none where complete
        size, found = rows[-1]["parameters"] / 1e6, rows[-1]
        print(f"{name:12} {size:.3f} M  mAP50 {found['map50']:.3f}  {found['map50_95']:.3f}")
    if args.json:
        write_text(args.json, json.dumps(rows, indent=1) + "\n")


if __name__ == "__main__":
    raise SystemExit(main())
