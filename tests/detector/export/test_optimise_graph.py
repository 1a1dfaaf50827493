"""Optimised graph against the plain one: equal outputs with less work."""

import numpy as np
import pytest

pytest.importorskip("torch")
pytest.importorskip("onnx")

import onnx
import onnxruntime as ort
import torch

from foreride.detector.export.convolution_steps import LANES
from foreride.detector.export.onnx_graph import Graph
from foreride.detector.export.optimise_graph import rewrite
from foreride.detector.export.quantize import to_half_precision
from foreride.detector.export.to_onnx import OPSET, to_onnx
from foreride.detector.export.verify import difference, runner
from foreride.detector.network.checkpoint import load_network
from foreride.detector.network.models import Network, build
from foreride.detector.runtime import WEIGHTS
from tests.detector.roads import draw


def network(name: str) -> Network:
    """The shipped weights, or random ones with norms that are not the identity."""
    if name == "sbp-yolo":
        return load_network(WEIGHTS.with_suffix(".pt"))[0]
    torch.manual_seed(0)
    model = build(name).eval()
    for module in model.modules():
        if isinstance(module, torch.nn.BatchNorm2d):
            module.running_mean.normal_(0, 0.1)
            module.running_var.uniform_(0.2, 0.3)
            torch.nn.init.normal_(module.bias, 0, 0.2)
    for branch in model.head.label:
        torch.nn.init.zeros_(branch.bias)  # scores in the middle of their range, where errors show
    return model


def images(count: int, side_px: int = 160) -> list[np.ndarray]:
    """Small synthetic roads."""
    rng = np.random.default_rng(1)
    return [draw(rng, side_px, side_px)[0] for _ in range(count)]


@pytest.mark.parametrize("name", ["sbp-yolo", "yolo11n"])
def test_a_hundred_images_give_equal_outputs(name: str) -> None:
    plain = to_onnx(network(name), {"names": "a"}, published=True)
    before, after = runner(plain), runner(rewrite(to_onnx(network(name), {"names": "a"})))
    made_up = images(100)
    assert max(np.ptp(before(i)[1]) for i in made_up) > 1e-2  # the scores differ enough for an error to show
    assert max(difference(before(i), after(i), 160) for i in made_up) <= 1e-5


@pytest.fixture(scope="module")
def graphs() -> tuple[Graph, Graph]:
    """Graph of the shipped weights, and the same optimised."""
    plain = to_onnx(network("sbp-yolo"), {})
    return Graph(plain), Graph(rewrite(plain))


def test_nothing_is_split_shuffled_or_joined_at_two_resolutions(graphs: tuple[Graph, Graph]) -> None:
    before, after = ([n.op_type for n in graph.nodes] for graph in graphs)
    assert after.count("Split") < before.count("Split")
    graph = graphs[1]
    assert not any(graph.shuffled(name) for name in graph.maker)
    assert not any(
        reader.op_type == "Concat"
        for node in graph.nodes
        if node.op_type == "Resize"
        for reader in graph.readers[node.output[0]]
    )


def test_less_is_convolved(graphs: tuple[Graph, Graph]) -> None:
    before, after = (products(graph) for graph in graphs)
    assert after < 0.95 * before


def test_few_channels_are_convolved_two_rows_at_a_time(graphs: tuple[Graph, Graph]) -> None:
    def narrow(graph: Graph) -> int:
        convs = [n for n in graph.nodes if n.op_type == "Conv" and graph.attribute(n, "kernel_shape")[0] > 1]
        return sum(
            graph.constants[n.input[1]].shape[0] < LANES and graph.attribute(n, "group") == 1 for n in convs
        )

    assert [narrow(graph) for graph in graphs] == [2, 0]


def products(graph: Graph) -> int:
    """Multiplications of the convolutions of an image of 128 × 128 pixels, outputs in vectors of `LANES`."""
    convolutions = [n for n in graph.nodes if n.op_type == "Conv"]
    model = onnx.helper.make_model(graph.graph, opset_imports=[onnx.helper.make_opsetid("", OPSET)])
    model.graph.output.extend(onnx.ValueInfoProto(name=n.output[0]) for n in convolutions)
    session = ort.InferenceSession(model.SerializeToString(), providers=["CPUExecutionProvider"])
    maps = session.run([n.output[0] for n in convolutions], {"image": images(1, 128)[0][None]})
    total = 0
    for node, made in zip(convolutions, maps, strict=True):
        outputs, *kernel = graph.constants[node.input[1]].shape
        total += made[0, 0].size * -(-outputs // LANES) * LANES * int(np.prod(kernel))
    return total


def test_the_original_is_left_alone() -> None:
    plain = to_onnx(network("sbp-yolo"), {})
    bytes_before = plain.SerializeToString()
    rewrite(plain)
    assert plain.SerializeToString() == bytes_before


def test_half_precision_halves_the_file_and_keeps_the_answer() -> None:
    model = rewrite(to_onnx(network("sbp-yolo"), {}))
    small = to_half_precision(model)
    assert small.ByteSize() < 0.6 * model.ByteSize()
    image = images(1)[0]
    assert difference(runner(model)(image), runner(small)(image), 160) < 2e-2
