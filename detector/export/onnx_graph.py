"""ONNX graph editing: producers and readers of tensors, constants, replacement of nodes."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from onnx import ModelProto, NodeProto, helper, numpy_helper

CHANNEL_PRESERVING = {"Sigmoid", "Mul", "Add", "Resize", "MaxPool"}
"""Operators whose output has as many channels as their first input."""


def copied(node: NodeProto, source: str, output: str) -> NodeProto:
    """Copy of a node that reads `source` first, named after its output."""
    copy = NodeProto()
    copy.CopyFrom(node)
    copy.input[0] = source
    copy.name = copy.output[0] = output
    return copy


def silu(source: str, output: str) -> list[NodeProto]:
    """Nodes of output = source · sigmoid(source)."""
    gate = f"{output}_gate"
    return [
        helper.make_node("Sigmoid", [source], [gate], gate),
        helper.make_node("Mul", [source, gate], [output], output),
    ]


class Graph:
    """Main graph of an ONNX model, edited in place.

    maker: node by name of its output. readers: nodes by name of an input. constants: arrays by name.
    """

    def __init__(self, model: ModelProto):
        self.graph = model.graph
        self.constants = {t.name: numpy_helper.to_array(t) for t in self.graph.initializer}
        for node in self.nodes:
            if node.op_type == "Constant" and node.attribute[0].name == "value":
                self.constants[node.output[0]] = numpy_helper.to_array(node.attribute[0].t)
            elif (
                node.op_type == "Identity" and node.input[0] in self.constants
            ):  # equal weights are stored once
                self.constants[node.output[0]] = self.constants[node.input[0]]
        self._index()

    @property
    def nodes(self) -> list[NodeProto]:
        """All nodes, in topological order."""
        return list(self.graph.node)

    def _index(self) -> None:
        self.maker = {name: node for node in self.graph.node for name in node.output}
        self.readers: dict[str, list[NodeProto]] = {}
        for node in self.graph.node:
            for name in node.input:
                self.readers.setdefault(name, []).append(node)

    def attribute(self, node: NodeProto, name: str) -> Any:
        """Value of an attribute, None if it is not set."""
        return next((helper.get_attribute_value(a) for a in node.attribute if a.name == name), None)

    def set_attribute(self, node: NodeProto, name: str, value: Any) -> None:
        """Set or replace an attribute."""
        for attribute in [a for a in node.attribute if a.name == name]:
            node.attribute.remove(attribute)
        node.attribute.append(helper.make_attribute(name, value))

    def constant(self, name: str, value: NDArray) -> str:
        """Store an array under a name, floats in single precision; returns the name."""
        value = value.astype(np.float32) if value.dtype.kind == "f" else value
        self.graph.initializer.append(numpy_helper.from_array(value, name))
        self.constants[name] = value
        return name

    def convolution(
        self, like: NodeProto, source: str, weight: NDArray, output: str, bias: NDArray | None = None
    ) -> NodeProto:
        """Convolution with the attributes (and, unless given, the bias) of another one."""
        node = copied(like, source, output)
        node.input[1] = self.constant(f"{output}_weight", weight)
        if bias is not None:
            node.input[2] = self.constant(f"{output}_bias", bias)
        return node

    def channels(self, name: str) -> int:
        """Number of channels of a feature map."""
        node = self.maker[name]
        if node.op_type == "Conv":
            return self.constants[node.input[1]].shape[0]
        if node.op_type == "Concat":
            return sum(self.channels(part) for part in node.input)
        if node.op_type in CHANNEL_PRESERVING:
            return self.channels(node.input[0])
        source = self.shuffled(name)
        if source is None:
            raise ValueError(f"{node.op_type} {name}: unknown number of channels")
        return self.channels(source)

    def line(self, name: str, kinds: Sequence[str]) -> list[NodeProto | None]:
        """Chain of nodes of these kinds ending in `name`, linked by first inputs; Nones if there is none."""
        chain: list[NodeProto | None] = []
        for kind in kinds:
            node = self.maker.get(name)
            if node is None or node.op_type != kind:
                return [None] * len(kinds)
            chain.append(node)
            name = node.input[0]
        return chain

    def shuffled(self, name: str) -> str | None:
        """x if `name` is shuffle(x) (reshape to pairs, transposition, reshape back), else None."""
        _, swap, pairs = self.line(name, ("Reshape", "Transpose", "Reshape"))
        if pairs is None or swap is None or self.attribute(swap, "perm") != [0, 2, 1, 3, 4]:
            return None
        return pairs.input[0]

    def replace(self, old: NodeProto, new: list[NodeProto]) -> None:
        """Replace an old node by new ones."""
        position = list(self.graph.node).index(old)
        del self.graph.node[position]
        for offset, node in enumerate(new):
            self.graph.node.insert(position + offset, node)
        self._index()

    def remove_unused(self) -> None:
        """Remove nodes and constants without readers."""
        needed = {output.name for output in self.graph.output}
        for node in reversed(self.nodes):
            if needed.isdisjoint(node.output):
                self.graph.node.remove(node)
            else:
                needed.update(node.input)
        for tensor in list(self.graph.initializer):
            if tensor.name not in needed:
                self.graph.initializer.remove(tensor)
        self._index()
