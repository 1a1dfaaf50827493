"""Steps of the graph optimisation that concern one convolution and what makes its input or reads its output.

Each takes a graph and a node, and replaces the node if it is of the step's kind. Outputs differ by rounding.
"""

import numpy as np
from numpy.typing import NDArray
from onnx import NodeProto, TensorProto, helper

from foreride.detector.export.onnx_graph import Graph, copied, silu

LANES = 16
"""Channels in a vector register of 512 bits: fewer outputs of a convolution cost as much as these."""


def convolve_uint8_image(graph: Graph, node: NodeProto) -> None:
    """Conv(scale · cast(image as C×H×W)) → Conv of the uint8 image as stored, rows of pixels of C values.

    A k×k convolution of C channels is a k×(k·C) one of a single channel, C·stride to the right at a time.
    """
    if node.op_type != "Conv":
        return
    scale, _, planes = graph.line(node.input[0], ("Mul", "Cast", "Transpose"))
    if scale is None or planes is None or graph.attribute(planes, "perm") != [0, 3, 1, 2]:
        return
    weight = graph.constants[node.input[1]] * graph.constants[scale.input[1]]
    outputs, channels, high, wide = weight.shape
    flat = weight.transpose(0, 2, 3, 1).reshape(outputs, 1, high, wide * channels)
    rows, plane, out = f"{node.output[0]}_rows", f"{node.output[0]}_plane", node.output[0]
    conv = graph.convolution(node, f"{out}_float", flat, out)
    pads, strides = graph.attribute(node, "pads"), graph.attribute(node, "strides")
    for name, value in {
        "kernel_shape": list(flat.shape[2:]),
        "pads": [pads[0], pads[1] * channels, pads[2], pads[3] * channels],
        "strides": [strides[0], strides[1] * channels],
    }.items():
        graph.set_attribute(conv, name, value)
    shape = graph.constant(f"{out}_shape", np.array([0, 0, -1], np.int64))
    axis = graph.constant(f"{out}_axis", np.array([1], np.int64))
    new = [
        helper.make_node("Reshape", [planes.input[0], shape], [rows], rows),
        helper.make_node("Unsqueeze", [rows, axis], [plane], plane),
        helper.make_node("Cast", [plane], [f"{out}_float"], f"{out}_float", to=TensorProto.FLOAT),
        conv,
    ]
    graph.replace(node, new)


def split_convolutions(graph: Graph, node: NodeProto) -> None:
    """Split(silu(Conv(x))) → one convolution for each part."""
    gated, conv = graph.line(node.input[0], ("Mul", "Conv")) if node.op_type == "Split" else (None, None)
    if gated is None or conv is None or len(graph.readers[gated.output[0]]) > 1:
        return
    ends = np.cumsum(graph.constants[node.input[1]])[:-1]
    weights, biases = (np.split(graph.constants[conv.input[i]], ends) for i in (1, 2))
    new = []
    for name, weight, bias in zip(node.output, weights, biases, strict=True):
        new.append(graph.convolution(conv, conv.input[0], weight, f"{name}_raw", bias))
        new += silu(f"{name}_raw", name)
    graph.replace(node, new)


def shuffle_after_sum(graph: Graph, node: NodeProto) -> None:
    """shuffle(a) + scale · x → shuffle(a + scale' · x'), where x' has the channels of x unshuffled.

    The convolutions that make and read x = silu(Conv) take the new order into their weights.
    """
    if node.op_type != "Add":
        return
    for shuffled, other in (node.input, node.input[::-1]):
        merge, swap, pairs = graph.line(shuffled, ("Reshape", "Transpose", "Reshape"))
        _, gated, _ = graph.line(other, ("Conv", "Mul", "Conv"))
        if merge is None or swap is None or pairs is None or gated is None:
            continue
        if graph.shuffled(shuffled) and _unshuffle_channels(graph, gated):
            out = node.output[0]
            new = [helper.make_node("Add", [pairs.input[0], other], [f"{out}_sum"], f"{out}_sum")]
            for old, name in ((pairs, f"{out}_pairs"), (swap, f"{out}_swapped"), (merge, out)):
                new.append(copied(old, new[-1].output[0], name))
            graph.replace(node, new)
            return


def _unshuffle_channels(graph: Graph, gated: NodeProto) -> bool:
    """Reorder the channels of x = silu(Conv) before a shuffle, if all that reads x are convolutions.

    Of these a 1×1 depthwise one (scale) keeps the new order, and the others give what they did.
    """
    name, conv = gated.output[0], graph.maker[gated.input[0]]
    readers = graph.readers[name]
    if any(reader.op_type != "Conv" for reader in readers) or len(graph.readers[conv.output[0]]) > 2:
        return False
    scales = [r for r in readers if graph.constants[r.input[1]].shape == (graph.channels(name), 1, 1, 1)]
    plain = [r for r in readers if graph.attribute(r, "group") == 1]
    if len(scales) != 1 or len(scales) + len(plain) != len(readers):
        return False
    for node, inputs, axis in [(n, (1, 2), 0) for n in (conv, *scales)] + [(n, (1,), 1) for n in plain]:
        for i in inputs:
            value = unshuffled(graph.constants[node.input[i]], axis)
            node.input[i] = graph.constant(f"{node.output[0]}_{i}_unshuffled", value)
    return True


def shuffle_into_weights(graph: Graph, node: NodeProto) -> None:
    """Conv(shuffle(x)) → Conv(x) with its input channels in the order of x."""
    source = graph.shuffled(node.input[0]) if node.op_type == "Conv" else None
    if source is not None:
        weight = unshuffled(graph.constants[node.input[1]])
        graph.replace(node, [graph.convolution(node, source, weight, node.output[0])])


def unshuffled(weight: NDArray, axis: int = 1) -> NDArray:
    """Weights for the channels before a shuffle that puts the even ones first."""
    order = np.arange(weight.shape[axis]).reshape(-1, 2).T.ravel()
    return np.take(weight, np.argsort(order), axis)


def pair_rows(graph: Graph, node: NodeProto) -> None:
    """silu(Conv) to few channels → silu(Conv) of two rows at a time to twice as many, then interleaved.

    A k×k convolution at two rows is one of k + 1 rows with a vertical stride of 2. It fills the vector of
    which the narrow one leaves half unused. The map must have an even number of rows.
    """
    gated, conv = graph.line(node.output[0], ("Mul", "Conv")) if node.op_type == "Mul" else (None, None)
    if gated is None or conv is None or graph.attribute(conv, "group") != 1:
        return
    weight, bias = (graph.constants[conv.input[i]] for i in (1, 2))
    outputs, channels, high, wide = weight.shape
    if 2 * outputs > LANES or high == 1 or graph.attribute(conv, "strides") != [1, 1]:
        return
    out = node.output[0]
    both = np.zeros((outputs, 2, channels, high + 1, wide), weight.dtype)
    both[:, 0, :, :-1] = both[:, 1, :, 1:] = weight
    both = both.reshape(2 * outputs, channels, high + 1, wide)
    pairs = graph.convolution(conv, conv.input[0], both, f"{out}_pairs_raw", np.repeat(bias, 2))
    graph.set_attribute(pairs, "kernel_shape", [high + 1, wide])
    graph.set_attribute(pairs, "strides", [2, 1])
    new = [
        pairs,
        *silu(f"{out}_pairs_raw", f"{out}_pairs"),
        *_interleaved(graph, conv.input[0], outputs, out),
    ]
    graph.replace(node, new)


def _interleaved(graph: Graph, like: str, channels: int, out: str) -> list[NodeProto]:
    """Nodes that turn `out`_pairs (C·2, H/2, W) into the rows of `out` (C, H, W), W being that of `like`."""
    split = graph.constant(f"{out}_split", np.array([0, channels, 2, -1], np.int64))
    whole = graph.constant(f"{out}_whole", np.array([0, channels, -1], np.int64))
    names = [f"{out}_{part}" for part in ("width", "split_shape", "shape", "rows", "turned")]
    width, split_shape, shape, rows, turned = names
    return [
        helper.make_node("Shape", [like], [width], width, start=3),
        helper.make_node("Concat", [split, width], [split_shape], split_shape, axis=0),
        helper.make_node("Concat", [whole, width], [shape], shape, axis=0),
        helper.make_node("Reshape", [f"{out}_pairs", split_shape], [rows], rows),
        helper.make_node("Transpose", [rows], [turned], turned, perm=[0, 1, 3, 2, 4]),
        helper.make_node("Reshape", [turned, shape], [out], out),
    ]
