"""Write a trained model as ONNX: `python -m detector.export --weights weights.pt --out sbp-yolo.onnx`.

The graph takes `image` (1, H, W, 3) uint8 RGB, H and W multiples of 32 from 64 on, and gives `boxes`
(1, 300, 4) in pixels and `scores` (1, 300, 2). It is checked against torch before it replaces anything.
"""

import argparse
import copy
import importlib.metadata
import io
import sys
import warnings
from collections.abc import Sequence
from pathlib import Path

import cv2
import numpy as np
import onnx
import onnxruntime as ort
import torch
from torch import nn
from torch.nn.utils.fusion import fuse_conv_bn_eval

from detector.blocks import Conv
from detector.checkpoint import load_weights
from detector.dataset import image_paths, read_image
from detector.deploy import Deployed
from detector.detection import CLASS_NAMES
from detector.models import SbpYolo
from files.atomic import write_bytes
from files.errors import InputError

TOLERANCE = 1e-4


def fused(model: SbpYolo) -> SbpYolo:
    """A copy for inference, each batch norm folded into its convolution."""
    model = copy.deepcopy(model).eval()
    for block in model.modules():
        if isinstance(block, Conv):
            block.conv = fuse_conv_bn_eval(block.conv, block.norm)
            block.norm = nn.Identity()  # type: ignore[assignment]
    return model


def to_onnx(model: SbpYolo, metadata: dict[str, str]) -> bytes:
    """The ONNX file of a model, with metadata."""
    stream = io.BytesIO()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # tracing fixes the number of candidates, which is meant
        torch.onnx.export(
            Deployed(fused(model)),
            (torch.zeros(1, 384, 640, 3, dtype=torch.uint8),),
            stream,  # type: ignore[arg-type]
            input_names=["image"],
            output_names=["boxes", "scores"],
            dynamic_axes={"image": {1: "height", 2: "width"}},
            opset_version=17,
            dynamo=False,
        )
    graph = onnx.load_from_string(stream.getvalue())
    onnx.helper.set_model_props(graph, metadata)
    onnx.checker.check_model(graph)
    return graph.SerializeToString()


def parity(model: SbpYolo, data: bytes, images: Sequence[np.ndarray]) -> float:
    """Largest difference between ONNX and torch: of a score, or of a box side over the image width.

    Each of torch's 100 best candidates is held against the ONNX candidate nearest to it, since rounding
    may swap candidates of nearly equal score.
    """
    options = ort.SessionOptions()
    options.intra_op_num_threads = 1
    session = ort.InferenceSession(data, options, providers=["CPUExecutionProvider"])
    deployed = Deployed(copy.deepcopy(model).eval())
    worst = 0.0
    for image in images:
        with torch.inference_mode():
            boxes, scores = deployed(torch.from_numpy(image)[None])
        other_boxes, other_scores = session.run(None, {"image": image[None]})
        ours = _candidates(boxes[0].numpy(), scores[0].numpy(), image.shape[1])[:100]
        theirs = _candidates(other_boxes[0], other_scores[0], image.shape[1])
        gap = np.abs(ours[:, None] - theirs[None]).max(2).min(1)
        worst = max(worst, float(gap.max()))
    return worst


def _candidates(boxes: np.ndarray, scores: np.ndarray, width: int) -> np.ndarray:
    """Rows of box over image width, and scores; the likeliest first."""
    order = np.argsort(-scores.max(1), kind="stable")
    return np.concatenate((boxes / width, scores), 1)[order]


def export(weights: Path, out: Path, version: str, images: Sequence[np.ndarray]) -> dict[str, str]:
    """Read weights, write the ONNX file if it agrees with torch on `images`; gives its metadata."""
    model = SbpYolo()
    made = load_weights(weights, model)
    model.eval()
    metadata = {
        "names": ",".join(CLASS_NAMES),
        "stride": "32",
        "preprocessing": "uint8 RGB, height x width x 3; scaling to 0..1 is inside the graph",
        "width": str(made.get("width", 640)),
        "dataset": str(made.get("dataset", "")),
        "passes": str(made.get("passes", 0)),
        "version": version,
    }
    data = to_onnx(model, metadata)
    gap = parity(model, data, images)
    if not gap <= TOLERANCE:
        raise InputError(f"{weights}: ONNX and torch differ by {gap:.2g}, allowed is {TOLERANCE:g}")
    write_bytes(out, data)
    return metadata


def main(arguments: Sequence[str] | None = None) -> int:
    p = argparse.ArgumentParser(prog="python -m detector.export", description=__doc__)
    p.add_argument("--weights", type=Path, required=True, help="weights file of detector.train")
    p.add_argument("--out", type=Path, required=True, help="ONNX file to write")
    p.add_argument("--data", type=Path, help="folder with images/ for the check against torch")
    args = p.parse_args(arguments)
    try:
        metadata = export(args.weights, args.out, _version(), check_images(args.data))
    except InputError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    print(f"{args.out}: {metadata}")
    return 0


def check_images(folder: Path | None, count: int = 4) -> list[np.ndarray]:
    """A few images cut to multiples of 32: of a folder, or smooth noise where none is given."""
    if folder is None:
        rng = np.random.default_rng(0)
        coarse = rng.integers(0, 256, (count, 12, 20, 3), dtype=np.uint8)
        return [cv2.resize(c, (640, 384), interpolation=cv2.INTER_CUBIC) for c in coarse]
    images = [read_image(path) for path in image_paths(folder)[:count]]
    return [np.ascontiguousarray(i[: i.shape[0] // 32 * 32, : i.shape[1] // 32 * 32]) for i in images]


def _version() -> str:
    try:
        return importlib.metadata.version("foreride")
    except importlib.metadata.PackageNotFoundError:
        return "unreleased"


if __name__ == "__main__":
    raise SystemExit(main())
