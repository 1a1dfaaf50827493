"""`foreride detector`: data, training, evaluation and export of the detector, each with its own options."""

import argparse
import importlib

from foreride.files.errors import InputError
from foreride.files.extras import install_command

MODULES = {
    "data": ("foreride.road.dataset.generate", "render a labelled image set"),
    "card": ("foreride.road.dataset.dataset_card", "write a rendered set's README.md"),
    "boxes": ("foreride.road.dataset.label_statistics", "box sizes of labelled folders"),
    "convert": ("foreride.detector.data.yolo_coco", "own images from and to YOLO and COCO formats"),
    "split": ("foreride.detector.data.split", "split own images into train/, val/ and test/"),
    "train": ("foreride.detector.training.train", "train SBP-YOLO or a rival (extra: training)"),
    "blend": (
        "foreride.detector.training.blend",
        "mean of the weights before and after a training (extra: training)",
    ),
    "eval": ("foreride.detector.evaluation.evaluate", "precision, recall and mAP on a folder of images"),
    "show": ("foreride.scenarios.commands.inspect.show", "draw boxes and ranges into own images or a film"),
    "mine": (
        "foreride.scenarios.commands.inspect.mine",
        "hard negatives: images with false boxes, to train on",
    ),
    "export": ("foreride.detector.export.to_onnx", "write ONNX from trained weights (extra: training)"),
    "bench": (
        "foreride.detector.export.benchmark",
        "time models, graphs, precisions, backends and threads (extra: training)",
    ),
    "models": (
        "foreride.detector.network.complexity",
        "parameters and operations beside the paper's (extra: training)",
    ),
}


def configure(command: argparse.ArgumentParser) -> None:
    """Add the step's name; the options after it belong to the step's module."""
    command.description = "; ".join(f"{name}: {text}" for name, (_, text) in MODULES.items())
    command.add_argument("step", choices=MODULES)
    command.add_argument("rest", nargs=argparse.REMAINDER, metavar="...", help="options; `--help` lists them")
    command.set_defaults(execute=execute)


def execute(arguments: argparse.Namespace) -> int:
    """Pass the remaining options to the module of this step."""
    name = MODULES[arguments.step][0]
    try:
        return int(importlib.import_module(name).main(arguments.rest) or 0)
    except ModuleNotFoundError as error:
        if error.name not in {"torch", "onnx"}:
            raise
        raise InputError(
            f"detector {arguments.step}: needs {error.name}: {install_command('training')}"
        ) from None
