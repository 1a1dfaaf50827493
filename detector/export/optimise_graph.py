"""ONNX graph optimisation for inference: equal outputs, less work (`foreride detector export --optimised`).

The input of a 1×1 convolution is often itself linear in other maps: a concatenation, an upsampled map, the
sum of a residual, a channel shuffle, a 1×1 depthwise convolution. As W·(a, b) = W_a·a + W_b·b, each such
convolution becomes a sum of 1×1 convolutions of the maps below, one for each resolution: the linear steps
are absorbed into the weights, and a map of half the resolution is convolved before it is upsampled, at a
quarter of the cost. Maps of the same resolution are concatenated and convolved at once, which rounds once.
"""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from onnx import ModelProto, NodeProto, helper

from foreride.detector.export.convolution_steps import (
    convolve_uint8_image,
    pair_rows,
    shuffle_after_sum,
    shuffle_into_weights,
    split_convolutions,
    unshuffled,
)
from foreride.detector.export.onnx_graph import Graph, copied

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


def rewrite(model: ModelProto) -> ModelProto:
    """Optimised copy of the model with fewer and cheaper nodes; outputs differ by rounding only."""
    copy = ModelProto()
    copy.CopyFrom(model)
    graph = Graph(copy)
    before = convolve_uint8_image, split_convolutions, shuffle_after_sum, shuffle_into_weights
    for step in (*before, _expand_convolutions, pair_rows):
        for node in graph.nodes:
            step(graph, node)
        graph.remove_unused()
    return copy


def _expand_convolutions(graph: Graph, node: NodeProto) -> None:
    """1×1 Conv of a linear expression → sum of 1×1 convolutions of its maps."""
    if node.op_type != "Conv" or graph.attribute(node, "group") != 1:
        return
    weight = graph.constants[node.input[1]]
    if weight.shape[2:] != (1, 1) or graph.attribute(node, "strides") != [1, 1]:
        return
    terms = LinearTerms(graph.constants[node.input[2]].astype(np.float64))
    _expand_terms(graph, terms, (), node.input[0], weight[:, :, 0, 0].astype(np.float64))
    if list(terms.weights) != [()] or list(terms.weights[()]) != [node.input[0]]:
        graph.replace(node, _sum(graph, node, terms))


def _expand_terms(graph: Graph, terms: LinearTerms, chain: Chain, name: str, weight: NDArray) -> None:
    """Add W · (map called name) to the terms, expanded into its source maps where these are linear.

    A sum is expanded where one of its addends is a term already, as it then costs no further product.
    """
    node = graph.maker.get(name)
    kind = node.op_type if node is not None else "input"
    source = graph.shuffled(name)
    if source is not None:
        _expand_terms(graph, terms, chain, source, unshuffled(weight))
    elif node is None:
        terms.add(chain, name, weight)
    elif kind == "Concat" and graph.attribute(node, "axis") == 1:
        widths = [graph.channels(part) for part in node.input]
        for part, columns in zip(node.input, np.split(weight, np.cumsum(widths)[:-1], 1), strict=True):
            _expand_terms(graph, terms, chain, part, columns)
    elif kind == "Resize":
        _expand_terms(graph, terms, (*chain, name), node.input[0], weight)
    elif kind == "Add" and not terms.weights.get(chain, {}).keys().isdisjoint(node.input):
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
    chains = sorted(terms.weights, key=len, reverse=True)
    for i, chain in enumerate(chains):
        maps = terms.weights[chain]
        source, name = _concatenation(graph, list(maps)), f"{out}_{i}"
        if not source:
            source = f"{name}_joined"
            nodes.append(helper.make_node("Concat", list(maps), [source], source, axis=1))
        bias = terms.bias if chain == chains[-1] else np.zeros_like(terms.bias)
        weight = np.concatenate(list(maps.values()), 1)[:, :, None, None]
        nodes.append(graph.convolution(old, source, weight, name, bias))
        for resize in reversed(chain):
            nodes.append(copied(graph.maker[resize], nodes[-1].output[0], f"{nodes[-1].output[0]}_up"))
        if total:
            both = [nodes[-1].output[0], total]
            nodes.append(helper.make_node("Add", both, [f"{name}_sum"], f"{name}_sum"))
        total = nodes[-1].output[0]
    nodes[-1].output[0] = out
    return nodes


def _concatenation(graph: Graph, maps: list[str]) -> str:
    """Name of the concatenation of these maps: of one the map itself; empty if the graph has none yet."""
    if len(maps) == 1:
        return maps[0]
    made = (n for n in graph.readers[maps[0]] if n.op_type == "Concat" and list(n.input) == maps)
    return next((n.output[0] for n in made if graph.attribute(n, "axis") == 1), "")
