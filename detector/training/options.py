"""Command-line options of `foreride detector train`."""

import argparse
from pathlib import Path

from foreride.detector.data.crops import ZOOM
from foreride.detector.network.models import MODELS
from foreride.detector.training.schedule import DECAYS
from foreride.files.command_line import Parser

SHIPPED = Path(__file__).parents[1] / "weights" / "sbp-yolo.pt"


def weights_file(text: str) -> Path:
    """Path of a weights file; `shipped` stands for that of the package."""
    return SHIPPED if text == "shipped" else Path(text)


def parser(description: str | None) -> argparse.ArgumentParser:
    """Command line of `detector train`."""
    p = Parser(prog="foreride detector train", description=description)
    p.add_argument("--data", type=Path, required=True, help="folder with train/ and val/")
    p.add_argument("--out", type=Path, required=True, help="folder for checkpoint, history and weights")
    p.add_argument("--stages", default="320x192:60000,640x384:15000", help="WIDTHxHEIGHT:PASSES[,...]")
    p.add_argument("--skip-bad", action="store_true", help="leave out unusable files")
    p.add_argument("--model", choices=MODELS, default="sbp-yolo", help="architecture to train")
    p.add_argument("--batch", type=int, default=16)
    p.add_argument("--rate", type=float, default=2e-3, help="peak learning rate of AdamW")
    p.add_argument("--decay", choices=DECAYS, default="linear", help="of the rate, after its warm-up")
    p.add_argument("--nwd-alpha", type=float, default=1.0, help="share of CIoU in the box loss; 1 = no NWD")
    p.add_argument("--nwd-scale", type=float, default=12.8, help="the constant C of the NWD, in strides")
    p.add_argument("--edge-weight", type=float, default=0.0, help="weight of the row edge error (strides)")
    _views(p)
    p.add_argument(
        "--auxiliary",
        action="store_true",
        help="learn the classes of auxiliary/*.txt, too, where images have them; weights are without them",
    )
    p.add_argument("--plain-last", type=float, default=0.1, help="share of passes at the end without mosaic")
    p.add_argument("--teacher", type=Path, help="weights file of a larger model to learn from (BCKD and CWD)")
    p.add_argument("--distil-logits", type=float, default=0.5, help="weight of BCKD; 0 = none")
    p.add_argument("--distil-features", type=float, default=0.5, help="weight of CWD; 0 = none")
    p.add_argument("--seed", type=int, default=0)
    p.add_argument("--init", type=weights_file, metavar="FILE", help="weights to start from, or `shipped`")
    p.add_argument("--resume", action="store_true", help="continue from the checkpoint in --out")
    p.add_argument("--device", default="auto", help="auto, cpu or cuda")
    p.add_argument(
        "--precision",
        choices=("auto", "bf16", "fp32"),
        default="auto",
        help="auto: bf16 if the device has instructions for it, else fp32",
    )
    p.add_argument("--threads", type=int, default=2, help="threads of torch on a CPU")
    p.add_argument("--memory-mib", type=float, default=2048, help="for decoded images; others are read again")
    p.add_argument("--workers", type=int, default=1, help="threads that prepare batches")
    p.add_argument(
        "--patience", type=int, default=0, help="stop after N validations without improvement; 0 = never"
    )
    p.add_argument("--validate-every", type=int, default=8000, help="passes between two validations")
    return p


def _views(p: argparse.ArgumentParser) -> None:
    """Options of the views that are made of the images."""
    p.add_argument("--mosaic", type=float, default=0.0, help="share of views made of four images")
    p.add_argument("--weather", type=float, default=0.0, help="share of views with added rain, snow or fog")
    p.add_argument(
        "--litter", type=float, default=0.0, help="share of views with leaves and stones added to the road"
    )
    p.add_argument(
        "--mix",
        action="append",
        default=[],
        metavar="DIR=SHARE",
        help="folder of more images, such as photographs, and their share of all views; may be repeated",
    )
    p.add_argument(
        "--views",
        choices=("auto", "host", "device"),
        default="auto",
        help="make views on the CPU, or on the device from images in its memory (auto: device, but on a CPU)",
    )
    p.add_argument(
        "--grow",
        action="store_true",
        help="device views: take in what is rendered into DATA/train meanwhile; no run repeats another then",
    )
    p.add_argument("--zoom", type=float, default=ZOOM, help="greatest scale of a crop over full resolution")
    p.add_argument(
        "--style", type=float, default=0.15, help="device views: share in the style of --mix images"
    )
