"""User-defined detector: a network in the layout of YOLO exports behind foreride's detector interface.

python examples/own_detector.py yolo.onnx mine.onnx --classes speed_bump,pothole
foreride run hump_flat_30 --perception camera --set detection.weights=mine.onnx

In: `images` (1, 3, H, W) float32 RGB 0..1; out: (1, 4 + classes, N) of centre x, centre y, width, height in
pixels and class scores. Out of this come `image` (1, h, w, 3) uint8 in, `boxes` (1, N, 4) as corners and
`scores` (1, N, 2) out, with the metadata that foreride asks for. Needs the package onnx.
"""

import argparse
from typing import Any

import onnx
from onnx import TensorProto, compose, helper, numpy_helper

import numpy as np  # isort: skip

OURS = ("speed_bump", "pothole")
GREY = 114 / 255


def convert(model: onnx.ModelProto, classes: list[str]) -> onnx.ModelProto:
    """The network between a head that takes a uint8 image and a tail that gives corners and our classes."""
    entry, out = model.graph.input[0], model.graph.output[0]
    height, width = (dimension.dim_value for dimension in entry.type.tensor_type.shape.dim[2:])
    opset = next(entry.version for entry in model.opset_import if entry.domain in ("", "ai.onnx"))
    before = head(height, width, opset, model.ir_version)
    after = tail([classes.index(name) for name in OURS], len(classes), opset, model.ir_version)
    network = compose.add_prefix(model, "network/")
    joined = compose.merge_models(before, network, [("prepared", f"network/{entry.name}")])
    joined = compose.merge_models(joined, after, [(f"network/{out.name}", "raw")])
    longest = str(width or 640)
    helper.set_model_props(joined, {"names": ",".join(OURS), "width": longest, "height": str(height or 640)})
    onnx.checker.check_model(joined)
    return joined


def head(height: int, width: int, opset: int, ir: int) -> onnx.ModelProto:
    """uint8 (1, h, w, 3) to float (1, 3, H, W), padded with grey where the network has one size."""
    nodes = [
        helper.make_node("Cast", ["image"], ["floats"], to=TensorProto.FLOAT),
        helper.make_node("Div", ["floats", "white"], ["scaled"]),
        helper.make_node("Transpose", ["scaled"], ["planes"], perm=[0, 3, 1, 2]),
    ]
    constants: dict[str, Any] = {
        "white": np.float32(255),
        "grey": np.float32(GREY),
        "zeros": np.zeros(4, np.int64),
    }
    constants["size"] = np.array([1, 3, height, width], np.int64)
    if height and width:
        nodes += [
            helper.make_node("Shape", ["planes"], ["shape"]),
            helper.make_node("Sub", ["size", "shape"], ["room"]),
            helper.make_node("Concat", ["zeros", "room"], ["pads"], axis=0),
            helper.make_node("Pad", ["planes", "pads", "grey"], ["prepared"]),
        ]
    else:
        nodes.append(helper.make_node("Identity", ["planes"], ["prepared"]))
    image = helper.make_tensor_value_info("image", TensorProto.UINT8, [1, "height", "width", 3])
    shape = [1, 3, height or "H", width or "W"]
    prepared = helper.make_tensor_value_info("prepared", TensorProto.FLOAT, shape)
    return graph("head", nodes, image, [prepared], constants, opset, ir)


def tail(order: list[int], classes: int, opset: int, ir: int) -> onnx.ModelProto:
    """(1, 4 + classes, N) to corners (1, N, 4) and the scores of our classes (1, N, 2)."""
    half = np.array([[1, 0, -0.5, 0], [0, 1, 0, -0.5], [1, 0, 0.5, 0], [0, 1, 0, 0.5]], np.float32)
    nodes = [
        helper.make_node("Transpose", ["raw"], ["rows"], perm=[0, 2, 1]),
        helper.make_node("Split", ["rows", "parts"], ["centred", "all_scores"], axis=2),
        helper.make_node("MatMul", ["centred", "to_corners"], ["boxes"]),
        helper.make_node("Gather", ["all_scores", "order"], ["scores"], axis=2),
    ]
    constants: dict[str, Any] = {"parts": np.array([4, classes], np.int64), "to_corners": half.T.copy()}
    constants["order"] = np.array(order, np.int64)
    raw = helper.make_tensor_value_info("raw", TensorProto.FLOAT, [1, 4 + classes, "N"])
    found = [
        helper.make_tensor_value_info("boxes", TensorProto.FLOAT, [1, "N", 4]),
        helper.make_tensor_value_info("scores", TensorProto.FLOAT, [1, "N", len(order)]),
    ]
    return graph("tail", nodes, raw, found, constants, opset, ir)


def graph(
    name: str,
    nodes: list[onnx.NodeProto],
    entry: onnx.ValueInfoProto,
    out: list[onnx.ValueInfoProto],
    constants: dict[str, Any],
    opset: int,
    ir: int,
) -> onnx.ModelProto:
    """A model of these nodes with the constants that they use."""
    used = {input_name for node in nodes for input_name in node.input}
    kept = [
        numpy_helper.from_array(np.asarray(value), key) for key, value in constants.items() if key in used
    ]
    made = helper.make_graph(nodes, name, [entry], out, kept)
    return helper.make_model(made, opset_imports=[helper.make_opsetid("", opset)], ir_version=ir)


if __name__ == "__main__":
    command = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    command.add_argument("source")
    command.add_argument("target")
    command.add_argument("--classes", default=",".join(OURS), help="the network's classes in their order")
    given = command.parse_args()
    onnx.save(convert(onnx.load(given.source), given.classes.split(",")), given.target)
