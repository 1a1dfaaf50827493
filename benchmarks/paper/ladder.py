"""Tables 1 and 3 of arXiv 2508.01339 on a folder of images: model ablation, distillation; and NWD.

`python -m benchmarks.paper.ladder --table 1|3|nwd --data DIR --out FOLDER --passes 60000 [--json FILE]`

Every row is trained for the same number of images, at the same size, on the same images, with the same seed,
and then validated on DIR/val; finished rows are read from their run folders, so an interrupted run can be
restarted.
"""

import argparse
import json
from collections.abc import Sequence
from pathlib import Path

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


def row(name: str, options: list[str], stage: Stage, args: argparse.Namespace) -> dict:
    """Train one row, unless its run folder is complete, and return its numbers. Raises InputError."""
    run, taught = args.out / name, name.startswith("+") and args.table == "3"
    teacher = ["--teacher", args.out / "teacher" / "weights.pt"] if taught else []
    train_ours(run, stage, args, *options, *teacher)
    last = read_history(run / "history.jsonl")[-1]
    kept = ("passes", "size", "map50", "map50_95", "precision", "recall")
    return {"row": name, "parameters": parameters(build(options[1]))} | {key: last[key] for key in kept}


@command
def main(arguments: Sequence[str] | None = None) -> None:
    p = argparse.ArgumentParser(description=__doc__)
    p.add_argument("--table", choices=TABLES, required=True)
    p.add_argument("--data", type=Path, required=True, help="folder with train/ and val/")
    p.add_argument("--out", type=Path, required=True, help="folder for the run folders of the rows")
    p.add_argument("--passes", type=int, default=60000, help="image passes of every row")
    p.add_argument("--size", default="640x384")
    p.add_argument("--batch", type=int, default=16)
    p.add_argument("--seed", type=int, default=0)
    p.add_argument("--threads", type=int, default=2)
    p.add_argument("--rows", help="names of rows, separated by commas (default all)")
    p.add_argument("--json", type=Path)
    args = p.parse_args(arguments)
    table = TABLES[args.table]
    names = parse_words("--rows", args.rows, list(table)) if args.rows else list(table)
    (stage,) = parse_stages(f"{args.size}:{args.passes}")
    for name in names:
        check_same_settings(args.out / name, settings_of(stage, args))
    rows = []
    for name in names:
        rows.append(row(name, table[name], stage, args))
        size, found = rows[-1]["parameters"] / 1e6, rows[-1]
        print(f"{name:12} {size:.3f} M  mAP50 {found['map50']:.3f}  {found['map50_95']:.3f}")
    if args.json:
        write_text(args.json, json.dumps(rows, indent=1) + "\n")


if __name__ == "__main__":
    raise SystemExit(main())
