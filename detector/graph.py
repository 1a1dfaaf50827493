"""Lookups in an ONNX graph under change: who makes a tensor, who reads it, what a constant holds."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from onnx import ModelProto, NodeProto, helper, numpy_helper

ONE_WIDTH = {"Sigmoid", "Mul", "Add", "Resize", "MaxPool"}
"""Operators whose output has as many channels as their first input."""


class Graph:
    """The main graph of a model, changed in place.

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
        return list(self.graph.node)

    def _index(self) -> None:
        self.maker = {name: node for node in self.graph.node for name in node.output}
        self.readers: dict[str, list[NodeProto]] = {}
        for node in self.graph.node:
            for name in node.input:
                self.readers.setdefault(name, []).append(node)

    def attribute(self, node: NodeProto, name: str) -> Any:
        """The value of an attribute, None where it is not set."""
        return next((helper.get_attribute_value(a) for a in node.attribute if a.name == name), None)

    def set_attribute(self, node: NodeProto, name: str, value: Any) -> None:
        for attribute in [a for a in node.attribute if a.name == name]:
            node.attribute.remove(attribute)
        node.attribute.append(helper.make_attribute(name, value))

    def constant(self, name: str, value: NDArray) -> str:
        """Store an array under a name, numbers with a fraction in single precision; gives the name."""
        value = value.astype(np.float32) if value.dtype.kind == "f" else value
        self.graph.initializer.append(numpy_helper.from_array(value, name))
        self.constants[name] = value
        return name

    def channels(self, name: str) -> int:
        """Number of channels of a map."""
        node = self.maker[name]
        if node.op_type == "Conv":
            return self.constants[node.input[1]].shape[0]
        if node.op_type == "Concat":
            return sum(self.channels(part) for part in node.input)
        if node.op_type in ONE_WIDTH:
            return self.channels(node.input[0])
        source = self.shuffled(name)
        if source is None:
            raise ValueError(f"{node.op_type} {name}: unknown number of channels")
        return self.channels(source)

    def line(self, name: str, kinds: Sequence[str]) -> list[NodeProto | None]:
        """Nodes of these kinds that make `name`, each from the first input of the one before, or Nones."""
        found: list[NodeProto | None] = []
        for kind in kinds:
            node = self.maker.get(name)
            if node is None or node.op_type != kind:
                return [None] * len(kinds)
            found.append(node)
            name = node.input[0]
        return found

    def shuffled(self, name: str) -> str | None:
        """x where `name` is shuffle(x), a reshape to pairs, a transposition and a reshape back; else None."""
        _, swap, pairs = self.line(name, ("Reshape", "Transpose", "Reshape"))
        if pairs is None or swap is None or self.attribute(swap, "perm") != [0, 2, 1, 3, 4]:
            return None
        return pairs.input[0]

    def replace(self, old: NodeProto, new: list[NodeProto]) -> None:
        """Put the new nodes in the place of an old one."""
        place = list(self.graph.node).index(old)
        del self.graph.node[place]
        for offset, node in enumerate(new):
            self.graph.node.insert(place + offset, node)
        self._index()

    def sweep(self) -> None:
        """Drop nodes and constants that nothing reads."""
        wanted = {output.name for output in self.graph.output}
        for node in reversed(self.nodes):
            if wanted.isdisjoint(node.output):
                self.graph.node.remove(node)
            else:
                wanted.update(node.input)
        for tensor in list(self.graph.initializer):
            if tensor.name not in wanted:
                self.graph.initializer.remove(tensor)
        self._index()
