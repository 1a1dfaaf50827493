"""Training of table rows: one folder each, resumed only with unchanged settings."""

import argparse
import json
from pathlib import Path

from foreride.detector.training.schedule import Stage
from foreride.detector.training.train import KIND
from foreride.detector.training.train import main as train
from foreride.files.errors import InputError
from foreride.files.reading.strict_json import read_json
from foreride.files.writing.atomic import write_text
from foreride.files.writing.folder import claim
from foreride.files.writing.scratch import MARKER


def settings_of(stage: Stage, args: argparse.Namespace) -> dict:
    """Settings common to all rows of a table, which must not change during training."""
    size = f"{stage.width}x{stage.height}"
    return {"size": size, "passes": stage.passes, "batch": args.batch, "seed": args.seed}


def check_same_settings(out: Path, asked: dict) -> None:
    """Raise InputError if a row's folder holds a training with other settings."""
    if not out.exists() or {path.name for path in out.iterdir()} <= {MARKER}:
        return
    found = _begun(out)
    for name, value in asked.items():
        if found.get(name) != value:
            raise InputError(
                f"{out}: trained with {name} {found.get(name)}, asked for is {value}; choose another --out"
            )


def _begun(out: Path) -> dict:
    """Settings of a row: from config.json of `detector train`, or from row.json of all others."""
    path = out / "config.json" if (out / "config.json").exists() else out / "row.json"
    try:
        told = read_json(path)
        if path.name == "row.json":
            return dict(told)
        settings = told["settings"]
        (stage,) = settings["stages"]
        size = {"size": f"{stage['width']}x{stage['height']}", "passes": stage["passes"]}
        return size | {"batch": settings["batch"], "seed": settings["seed"]}
    except (OSError, ValueError, KeyError, TypeError) as error:
        problem = f"{type(error).__name__}: {error}"
        raise InputError(
            f"{path}: must tell what {out} was trained with ({problem}); choose another --out"
        ) from None


def record_settings(out: Path, asked: dict) -> None:
    """Record the settings of a row, unless recorded. Raises InputError if they differ."""
    check_same_settings(out, asked)
    claim(out, KIND)
    write_text(out / "row.json", json.dumps(asked) + "\n")


def train_ours(out: Path, stage: Stage, args: argparse.Namespace, *options: object) -> None:
    """Run `detector train` with the table's settings and a row's options, unless the folder is complete.

    An interrupted training is resumed. Raises InputError.
    """
    check_same_settings(out, settings_of(stage, args))
    if (out / "weights.pt").exists():
        return
    words = ["--data", args.data, "--out", out, "--stages", stage, "--seed", args.seed, *options]
    words += ["--batch", args.batch, "--threads", args.threads, "--validate-every", stage.passes]
    if (out / "checkpoint.pt").exists():
        words.append("--resume")
    if train([str(word) for word in words]):
        raise InputError(f"{out.name}: training failed")
