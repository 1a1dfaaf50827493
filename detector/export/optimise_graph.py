"""ONNX graph optimisation for inference: equal outputs, less work (`foreride detector export --optimised`).

The input of a 1×1 convolution is often itself linear in other maps: a concatenation, an upsampled map, the
sum of a residual, a channel shuffle, a 1×1 depthwise convolution. As W·(a, b) = W_a·a + W_b·b, each such
convolution becomes a sum of 1×1 convolutions of the maps below: the linear steps are absorbed into the
weights, and a map of half the resolution is convolved before it is upsampled, at a quarter of the cost.
"""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from onnx import ModelProto, NodeProto, TensorProto, helper

from foreride.detector.export.onnx_graph import Graph

Chain = tuple[str, ...]
"""Outputs of the Resize nodes between a map and the convolution, nearest to the convolution first."""


@dataclass
class LinearTerms:
    """Linear expression Σ W·x + bias: weights by chain of upsamplings and map x."""

    bias: NDArray
    weights: dict[Chain, dict[str, NDArray]] = field(default_factory=dict)

    def add(self, chain: Chain, name: str, weight: NDArray) -> None:
        """Add W · (map called name) under a chain of upsamplings."""
        maps = self.weights.setdefault(chain, {})
        maps[name] = maps[name] + weight if name in maps else weight


def rewrite(model: ModelProto, join: bool = False) -> ModelProto:
    """Optimised copy of the model with fewer and cheaper nodes; outputs differ by rounding only.

    join: concatenate maps of the same resolution and convolve them at once, which suits integer arithmetic,
    where each partial sum would have to be rounded.
    """
    copy = ModelProto()
    copy.CopyFrom(model)
    graph = Graph(copy)
    for step in (_convolve_uint8_image, _split_convolutions, _shuffle_into_weights):
        for node in graph.nodes:
            step(graph, node)
        graph.remove_unused()
    for node in graph.nodes:
        _expand_convolutions(graph, node, join)
    graph.remove_unused()
    return copy


def _convolve_uint8_image(graph: Graph, node: NodeProto) -> None:
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
    conv = _convolution(graph, node, f"{out}_float", flat, out)
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


def _split_convolutions(graph: Graph, node: NodeProto) -> None:
    """Split(silu(Conv(x))) → one convolution for each part."""
    mul = graph.maker.get(node.input[0]) if node.op_type == "Split" else None
    conv = graph.maker.get(mul.input[0]) if mul is not None and mul.op_type == "Mul" else None
    if mul is None or conv is None or conv.op_type != "Conv" or len(graph.readers[mul.output[0]]) > 1:
        return
    sizes = graph.constants[node.input[1]]
    weight, bias = graph.constants[conv.input[1]], graph.constants[conv.input[2]]
    new, start = [], 0
    for name, size in zip(node.output, sizes, strict=True):
        rows = slice(start, start + int(size))
        raw = _convolution(graph, conv, conv.input[0], weight[rows], f"{name}_raw", bias[rows])
        sigmoid = helper.make_node("Sigmoid", [f"{name}_raw"], [f"{name}_gate"], f"{name}_gate")
        new += [raw, sigmoid, helper.make_node("Mul", [f"{name}_raw", f"{name}_gate"], [name], name)]
        start += int(size)
    graph.replace(node, new)


def _shuffle_into_weights(graph: Graph, node: NodeProto) -> None:
    """Conv(shuffle(x)) → Conv(x) with its input channels in the order of x."""
    source = graph.shuffled(node.input[0]) if node.op_type == "Conv" else None
    if source is not None:
        weight = _unshuffled(graph.constants[node.input[1]])
        graph.replace(node, [_convolution(graph, node, source, weight, node.output[0])])


def _expand_convolutions(graph: Graph, node: NodeProto, join: bool) -> None:
    """1×1 Conv of a linear expression → sum of 1×1 convolutions of its maps."""
    if node.op_type != "Conv" or graph.attribute(node, "group") != 1:
        return
    weight = graph.constants[node.input[1]]
    if weight.shape[2:] != (1, 1) or graph.attribute(node, "strides") != [1, 1]:
        return
    terms = LinearTerms(graph.constants[node.input[2]].astype(np.float64))
    _expand_terms(graph, terms, (), node.input[0], weight[:, :, 0, 0].astype(np.float64))
    if list(terms.weights) != [()] or list(terms.weights[()]) != [node.input[0]]:
        joined = _join(terms, node.output[0]) if join else []
        graph.replace(node, joined + _sum(graph, node, terms))


def _join(terms: LinearTerms, out: str) -> list[NodeProto]:
    """Concatenate the maps of each resolution; returns the nodes that do it."""
    nodes = []
    for chain, maps in terms.weights.items():
        if len(maps) > 1:
            name = f"{out}_{len(chain)}_joined"
            nodes.append(helper.make_node("Concat", list(maps), [name], name, axis=1))
            terms.weights[chain] = {name: np.concatenate(list(maps.values()), 1)}
    return nodes


def _expand_terms(graph: Graph, terms: LinearTerms, chain: Chain, name: str, weight: NDArray) -> None:
    """Add W · (map called name) to the terms, expanded into its source maps where these are linear."""
    node = graph.maker.get(name)
    kind = node.op_type if node is not None else "input"
    source = graph.shuffled(name)
    if source is not None:
        _expand_terms(graph, terms, chain, source, _unshuffled(weight))
    elif node is None:
        terms.add(chain, name, weight)
    elif kind == "Concat" and graph.attribute(node, "axis") == 1:
        widths = [graph.channels(part) for part in node.input]
        for part, columns in zip(node.input, np.split(weight, np.cumsum(widths)[:-1], 1), strict=True):
            _expand_terms(graph, terms, chain, part, columns)
    elif kind == "Resize":
        _expand_terms(graph, terms, (*chain, name), node.input[0], weight)
    elif kind == "Add" and len(graph.readers[name]) == 1:
        for part in node.input:
            _expand_terms(graph, terms, chain, part, weight)
    elif kind == "Conv" and graph.constants[node.input[1]].shape[1:] == (1, 1, 1):
        terms.bias += weight @ graph.constants[node.input[2]]
        _expand_terms(
            graph, terms, chain, node.input[0], weight * graph.constants[node.input[1]].reshape(1, -1)
        )
    else:
        terms.add(chain, name, weight)


def _sum(graph: Graph, old: NodeProto, terms: LinearTerms) -> list[NodeProto]:
    """Nodes that sum the terms under the name of the old convolution's output; coarse maps first."""
    out, nodes, total = old.output[0], [], ""
    for chain in sorted(terms.weights, key=len, reverse=True):
        subtotal = "" if chain else total
        for i, (name, weight) in enumerate(terms.weights[chain].items()):
            last = chain == min(terms.weights, key=len) and i == len(terms.weights[chain]) - 1
            term_name = f"{out}_{len(chain)}_{i}"
            bias = terms.bias if last else np.zeros_like(terms.bias)
            weight = weight[:, :, None, None]
            nodes.append(
                _convolution(graph, old, name, weight.astype(np.float32), term_name, bias.astype(np.float32))
            )
            if subtotal:
                nodes.append(
                    helper.make_node("Add", [term_name, subtotal], [f"{term_name}_sum"], f"{term_name}_sum")
                )
            subtotal = nodes[-1].output[0]
        for name in reversed(chain):
            resize = NodeProto()
            resize.CopyFrom(graph.maker[name])
            resize.input[0], resize.output[0] = subtotal, f"{subtotal}_up"
            resize.name = subtotal = resize.output[0]
            nodes.append(resize)
        if chain and total:
            nodes.append(helper.make_node("Add", [subtotal, total], [f"{subtotal}_all"], f"{subtotal}_all"))
            subtotal = nodes[-1].output[0]
        total = subtotal
    nodes[-1].output[0] = out
    return nodes


def _unshuffled(weight: NDArray) -> NDArray:
    """Weights for the input channels before a shuffle that puts the even ones first."""
    order = np.arange(weight.shape[1]).reshape(-1, 2).T.ravel()
    return weight[:, np.argsort(order)]


def _convolution(
    graph: Graph, like: NodeProto, source: str, weight: NDArray, out: str, bias: NDArray | None = None
) -> NodeProto:
    """Convolution with the attributes (and, unless given, the bias) of another one."""
    node = NodeProto()
    node.CopyFrom(like)
    node.name = node.output[0] = out
    node.input[0], node.input[1] = source, graph.constant(f"{out}_weight", weight)
    if bias is not None:
        node.input[2] = graph.constant(f"{out}_bias", bias)
    return node
