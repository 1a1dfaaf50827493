"""ONNX export of a trained model: `foreride detector export --weights weights.pt --out sbp-yolo.onnx`.

The graph takes `image` (1, H, W, 3) uint8 RGB, H and W multiples of 32 and >= 64, and gives `boxes`
(1, 300, 4) in pixels and `scores` (1, 300, 2). It is optimised for inference (`--plain`: left as published),
and compared with torch, image by image, before it replaces any file.
"""

import argparse
import copy
import importlib.metadata
import io
import warnings
from collections.abc import Sequence
from pathlib import Path

import cv2
import numpy as np
import onnx
import torch
from torch import nn
from torch.nn.utils.fusion import fuse_conv_bn_eval

from foreride.detector.calibration import KEY, Calibration, read_calibration, read_file, to_text
from foreride.detector.data.image_io import read_image
from foreride.detector.data.yolo_folder import image_paths
from foreride.detector.detections import CLASS_NAMES
from foreride.detector.export.optimise_graph import rewrite
from foreride.detector.export.quantize import quantized, to_half_precision
from foreride.detector.export.verify import parity
from foreride.detector.network.blocks import Conv
from foreride.detector.network.checkpoint import DEFAULT_MODEL, load_network
from foreride.detector.network.deployed import Deployed
from foreride.detector.network.models import Network
from foreride.files.command_line import Parser, notify
from foreride.files.errors import InputError
from foreride.files.writing.atomic import write_bytes
from foreride.files.writing.targets import check_files

OPSET = 17
PRECISIONS = ("fp32", "fp16", "int8", "int8-conv")
TOLERANCE = {"fp32": 1e-4, "fp16": 2e-2}
"""Largest difference allowed between ONNX and torch: of a score, or of a box side over the image width."""
CALIBRATION_IMAGES = 32


def fused(model: Network) -> Network:
    """Copy for inference, with each batch norm folded into its convolution."""
    model = copy.deepcopy(model).eval()
    for block in model.modules():
        if isinstance(block, Conv):
            block.conv = fuse_conv_bn_eval(block.conv, block.norm)
            block.norm = nn.Identity()  # type: ignore[assignment]
    return model


def to_onnx(model: Network, metadata: dict[str, str], published: bool = False) -> onnx.ModelProto:
    """ONNX graph of a model, with metadata; `published`: with boxes decoded at every point."""
    stream = io.BytesIO()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # tracing fixes the number of candidates, as intended
        torch.onnx.export(
            Deployed(fused(model), published),
            (torch.zeros(1, 384, 640, 3, dtype=torch.uint8),),
            stream,  # type: ignore[arg-type]
            input_names=["image"],
            output_names=["boxes", "scores"],
            dynamic_axes={"image": {1: "height", 2: "width"}},
            opset_version=OPSET,
            dynamo=False,
        )
    graph = onnx.load_from_string(stream.getvalue())
    onnx.helper.set_model_props(graph, metadata)
    onnx.checker.check_model(graph)
    return graph


def export(
    weights: Path,
    out: Path,
    version: str,
    images: Sequence[np.ndarray],
    plain: bool = False,
    precision: str = "fp32",
    calibration: Calibration | None = None,
) -> dict[str, str]:
    """Export weights to an ONNX file that agrees with torch on `images`; returns its metadata.

    8-bit graphs are calibrated on the images, and are less precise: judge them by an evaluation.
    calibration: of edge biases and scores, instead of that in the weights' metadata.
    """
    model, training_metadata = load_network(weights)
    metadata = {
        "names": ",".join(CLASS_NAMES),
        "model": str(training_metadata.get("model", DEFAULT_MODEL)),
        "graph": "plain" if plain else "optimised",
        "precision": precision,
        "stride": "32",
        "preprocessing": "uint8 RGB, height x width x 3; scaling to 0..1 is inside the graph",
        "width": str(training_metadata.get("width", 640)),
        "dataset": str(training_metadata.get("dataset", "")),
        "passes": str(training_metadata.get("passes", 0)),
        "version": version,
    }
    if calibration := calibration or read_calibration(training_metadata, str(weights)):
        metadata[KEY] = to_text(calibration)
    graph = to_onnx(model, metadata, published=plain)
    if not plain and precision != "int8-conv":  # which OpenVINO quantises best as published
        graph = rewrite(graph)
    if precision.startswith("int8"):
        graph = quantized(graph, images, convolutions_only=precision == "int8-conv")
    elif precision == "fp16":
        graph = to_half_precision(graph)
    difference, allowed = parity(model, graph, images[:4]), TOLERANCE.get(precision, 1.0)
    if not difference <= allowed:
        raise InputError(f"{weights}: ONNX and torch differ by {difference:.2g}, allowed is {allowed:g}")
    write_bytes(out, graph.SerializeToString())
    return metadata


def parser() -> argparse.ArgumentParser:
    """Command line of `detector export`."""
    p = Parser(prog="foreride detector export", description=__doc__)
    p.add_argument("--weights", type=Path, required=True, help="weights file of `detector train`")
    p.add_argument("--out", type=Path, required=True, help="ONNX file to write")
    p.add_argument("--data", type=Path, help="folder with images/, for comparison with torch and calibration")
    p.add_argument("--calibration", type=Path, help="JSON file of edge biases and score curves, by class")
    kind = p.add_mutually_exclusive_group()
    kind.add_argument("--optimised", action="store_true", help="graph optimised for inference (default)")
    kind.add_argument("--plain", action="store_true", help="graph as published")
    p.add_argument(
        "--precision",
        choices=PRECISIONS,
        default="fp32",
        help="int8 (for onnxruntime) and int8-conv (for OpenVINO) need --data",
    )
    return p


def main(arguments: Sequence[str] | None = None) -> int:
    """Command line; exit code 0, or 2 on bad input."""
    args = parser().parse_args(arguments)
    try:
        check_files(args.out, inputs=[args.weights])
        needs_calibration = args.precision.startswith("int8")
        if needs_calibration and args.data is None:
            raise InputError(
                f"--precision {args.precision}: needs --data, a folder with images/ to calibrate on"
            )
        images = check_images(args.data, CALIBRATION_IMAGES if needs_calibration else 4)
        calibration = None if args.calibration is None else read_file(args.calibration)
        metadata = export(args.weights, args.out, _version(), images, args.plain, args.precision, calibration)
    except InputError as error:
        notify(error)
        return 2
    print(f"{args.out}: {metadata}")
    return 0


def check_images(folder: Path | None, count: int = 4) -> list[np.ndarray]:
    """Images of one size, cut to multiples of 32: spread over a folder, or else smooth noise."""
    if folder is None:
        rng = np.random.default_rng(0)
        coarse = rng.integers(0, 256, (count, 12, 20, 3), dtype=np.uint8)
        return [cv2.resize(c, (640, 384), interpolation=cv2.INTER_CUBIC) for c in coarse]
    paths = image_paths(folder)
    images = [read_image(path) for path in paths[:: max(1, len(paths) // count)][:count]]
    images = [i[: i.shape[0] // 32 * 32, : i.shape[1] // 32 * 32] for i in images]
    return [np.ascontiguousarray(i) for i in images if i.shape == images[0].shape]


def _version() -> str:
    try:
        return importlib.metadata.version("foreride")
    except importlib.metadata.PackageNotFoundError:
        return "unreleased"


if __name__ == "__main__":
    raise SystemExit(main())
