"""Quantised and float parts of an 8-bit graph."""

import numpy as np
import pytest

pytest.importorskip("torch")
pytest.importorskip("onnx")

import onnx

from foreride.detector.export.quantize import quantized
from foreride.detector.export.to_onnx import to_onnx
from foreride.detector.export.verify import difference, runner
from foreride.detector.network.checkpoint import load_network
from foreride.detector.runtime import WEIGHTS
from tests.detector.roads import draw


def test_convolutions_in_eight_bits_keep_their_sums_and_the_classes_in_float() -> None:
    rng = np.random.default_rng(2)
    images = [draw(rng, 128, 128)[0] for _ in range(3)]
    plain = to_onnx(load_network(WEIGHTS.with_suffix(".pt"))[0], {"names": "kept"})
    quantised = quantized(plain, images, convolutions_only=True)
    maker = {name: node for node in quantised.graph.node for name in node.output}
    readers = [(name, node.op_type) for node in quantised.graph.node for name in node.input]
    convolutions = [node for node in quantised.graph.node if node.op_type == "Conv"]
    in_float = [n.name for n in convolutions if maker[n.input[0]].op_type != "DequantizeLinear"]
    assert len(in_float) == 4  # the class branch of each level
    assert all("/head/label" in name for name in in_float)
    outputs = {node.output[0] for node in convolutions}
    assert not any(kind == "QuantizeLinear" and name in outputs for name, kind in readers)
    eight = sum(
        t.data_type == onnx.TensorProto.INT8 and len(t.dims) == 4 for t in quantised.graph.initializer
    )
    assert eight == len(convolutions) - len(in_float)
    assert {p.key: p.value for p in quantised.metadata_props} == {"names": "kept"}
    assert quantised.ByteSize() < 0.4 * plain.ByteSize()
    assert difference(runner(plain)(images[0]), runner(quantised)(images[0]), 128) < 0.1
