"""Network of an ONNX file as an OpenVINO model for images of one size."""

from pathlib import Path

import numpy as np
import openvino
from numpy.typing import NDArray
from openvino import opset13 as ops


def read_model(path: Path, size: tuple[int, int]) -> openvino.Model:
    """Model for images of a size (width, height). Raises RuntimeError if OpenVINO cannot read the file."""
    model = openvino.Core().read_model(path)
    model.reshape({"image": [1, size[1], size[0], 3]})
    _widen_first_convolution(model)
    return model


def _widen_first_convolution(model: openvino.Model) -> None:
    """First convolution of one channel, if the graph has it, with the values between two strides as channels.

    The export convolves the rows of the image as stored; OpenVINO is slow with one channel.
    """
    nodes = model.get_ordered_ops()
    first = next((node for node in nodes if node.get_type_name() == "Convolution"), None)
    if first is None or first.input_value(1).get_node().get_type_name() != "Constant":
        return
    weight = first.input_value(1).get_node().get_data()
    how = first.get_attributes()
    (down, across), (top, left), (bottom, _) = (how[k] for k in ("strides", "pads_begin", "pads_end"))
    if weight.shape[1] != 1 or how["dilations"] != [1, 1]:
        return
    planes = ops.transpose(
        ops.reshape(model.input("image").get_node(), [0, 0, -1, across], special_zero=True), [0, 3, 1, 2]
    )
    wide = ops.convolution(
        ops.convert(planes, "f32"),
        ops.constant(_blocks(weight, across, left)),
        [down, 1],
        [top, -(-left // across)],
        [bottom, 0],
        [1, 1],
    )
    if wide.get_output_shape(0) == first.get_output_shape(0):
        first.output(0).replace(wide.output(0))
        model.validate_nodes_and_infer_types()


def _blocks(weight: NDArray, step: int, left: int) -> NDArray:
    """Weights (outputs, step, rows, blocks): columns of (outputs, 1, rows, columns) in blocks of `step`.

    The first column is `left` before the start of a block.
    """
    outputs, _, rows, columns = weight.shape
    before = -left % step
    blocks = -(-(before + columns) // step)
    filled = np.zeros((outputs, rows, blocks * step), weight.dtype)
    filled[:, :, before : before + columns] = weight[:, 0]
    return np.ascontiguousarray(filled.reshape(outputs, rows, blocks, step).transpose(0, 3, 1, 2))
