"""Reduced precision of an exported graph: weights in half precision, or static 8-bit integers (QDQ).

Needs the package onnx (extra: training); the result needs onnxruntime only.
"""

import logging
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
import onnx
from numpy.typing import NDArray
from onnx import ModelProto, TensorProto, helper, numpy_helper
from onnxruntime.quantization import (
    CalibrationDataReader,
    CalibrationMethod,
    QuantFormat,
    QuantType,
    quantize_static,
)
from onnxruntime.quantization.shape_inference import quant_pre_process

QUANTIZED = ["Conv", "Sigmoid", "Mul", "Concat", "Resize", "MaxPool", "Add"]
"""Operators quantised for onnxruntime: conversions between them would cost more than they save."""
FLOAT_PARTS = ("/stem/", "/attention/", "/head/label", "/head/shared")
"""Parts that stay in single precision: the first convolution, attention and the head, as onnxruntime has no
fast 8-bit convolution of a few channels or small groups."""
CLASS_BRANCH = ("/head/label",)
"""Parts in float where only convolutions are quantised: in 8 bits they cost 0.5 points of mAP50; for the stem
and the rest of the head no loss could be measured."""


def to_half_precision(model: ModelProto) -> ModelProto:
    """Copy with weights stored in half precision and computed in single: half the size, no faster."""
    copy = ModelProto()
    copy.CopyFrom(model)
    casts = []
    for tensor in copy.graph.initializer:
        if tensor.data_type == TensorProto.FLOAT and np.prod(tensor.dims) > 1:
            name = tensor.name
            value = numpy_helper.to_array(tensor).astype(np.float16)
            tensor.CopyFrom(numpy_helper.from_array(value, f"{name}_half"))
            casts.append(
                helper.make_node("Cast", [f"{name}_half"], [name], f"{name}_cast", to=TensorProto.FLOAT)
            )
    for cast in reversed(casts):
        copy.graph.node.insert(0, cast)
    return copy


class Images(CalibrationDataReader):
    """Calibration reader: images (H, W, 3) uint8, one at a time."""

    def __init__(self, images: Sequence[NDArray[np.uint8]]):
        self.rest: Iterator[NDArray[np.uint8]] = iter(images)

    def get_next(self) -> dict[str, NDArray[np.uint8]] | None:
        """Next input of the network by name; None at the end."""
        image = next(self.rest, None)
        return None if image is None else {"image": image[None]}


def quantized(
    model: ModelProto,
    images: Sequence[NDArray[np.uint8]],
    convolutions_only: bool = False,
    in_float: Sequence[str] | None = None,
) -> ModelProto:
    """Copy with 8-bit weights and activations, ranges taken from `images`, all of one size.

    convolutions_only: quantise inputs and weights of convolutions, but keep their sums and SiLU in float,
    which OpenVINO fuses into one step. in_float: parts of the names of nodes that stay in single precision,
    by default those measured to be best.
    """
    kinds = ["Conv"] if convolutions_only else QUANTIZED
    if in_float is None:
        in_float = CLASS_BRANCH if convolutions_only else FLOAT_PARTS
    conv_only_options = {"OpTypesToExcludeOutputQuantization": ["Conv"], "QuantizeBias": False}
    props = {p.key: p.value for p in model.metadata_props}
    with tempfile.TemporaryDirectory() as folder:
        source, prepared, out = (Path(folder) / name for name in ("a.onnx", "b.onnx", "c.onnx"))
        onnx.save(model, source)
        quant_pre_process(source, prepared, skip_symbolic_shape=True, skip_optimization=True)
        nodes = onnx.load(prepared).graph.node
        float_nodes = [n.name for n in nodes if n.op_type in kinds and _stays_float(n, in_float)]
        logging.getLogger().setLevel(logging.ERROR)
        quantize_static(
            prepared,
            out,
            Images(images),
            QuantFormat.QDQ,
            op_types_to_quantize=kinds,
            per_channel=True,
            activation_type=QuantType.QUInt8,
            weight_type=QuantType.QInt8,
            nodes_to_exclude=float_nodes,
            calibrate_method=CalibrationMethod.MinMax,
            extra_options=conv_only_options if convolutions_only else {},
        )
        result = onnx.load(out)
    helper.set_model_props(result, props)
    return result


def _stays_float(node: onnx.NodeProto, in_float: Sequence[str]) -> bool:
    """True for a node that stays in float: by name, or because it computes no feature of the image."""
    names = (node.name, *node.output)
    return any(part in name for part in in_float for name in names) or not any("/model/" in n for n in names)
