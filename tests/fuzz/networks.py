"""Tiny ONNX detectors with chosen answers, for tests of what reads and runs them."""

from pathlib import Path

import numpy as np
import onnx
from onnx import TensorProto, helper, numpy_helper

METADATA = {"names": "speed_bump,pothole", "width": "640"}


def write(
    path: Path,
    boxes: np.ndarray,
    scores: np.ndarray,
    metadata: dict[str, str] = METADATA,
    shape: tuple[int | str | None, ...] = (1, "height", "width", 3),
) -> Path:
    """A network that gives these boxes and scores for every image of the shape."""
    constants = [numpy_helper.from_array(value, name) for value, name in ((boxes, "b"), (scores, "s"))]
    nodes = [
        helper.make_node("Cast", ["image"], ["floats"], to=TensorProto.FLOAT),
        helper.make_node("ReduceMax", ["floats"], ["brightest"], keepdims=0),
        helper.make_node("Sub", ["brightest", "brightest"], ["nothing"]),
        helper.make_node("Add", ["b", "nothing"], ["boxes"]),
        helper.make_node("Add", ["s", "nothing"], ["scores"]),
    ]
    return save(path, nodes, constants, metadata, shape, (boxes.shape, scores.shape))


def save(
    path: Path,
    nodes: list[onnx.NodeProto],
    constants: list[onnx.TensorProto],
    metadata: dict[str, str] = METADATA,
    shape: tuple[int | str | None, ...] = (1, "height", "width", 3),
    answers: tuple[tuple[int, ...] | None, tuple[int, ...] | None] = (None, None),
) -> Path:
    """A network of these nodes from `image` to `boxes` and `scores`."""
    image = helper.make_tensor_value_info("image", TensorProto.UINT8, shape)
    out = [
        helper.make_tensor_value_info(name, TensorProto.FLOAT, size)
        for name, size in zip(("boxes", "scores"), answers, strict=True)
    ]
    graph = helper.make_graph(nodes, "tiny", [image], out, constants)
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)], ir_version=8)
    helper.set_model_props(model, metadata)
    onnx.save(model, path)
    return path
