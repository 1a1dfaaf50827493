"""Optimised graph against the plain one: equal outputs with less work."""

import numpy as np
import pytest

pytest.importorskip("torch")
pytest.importorskip("onnx")

import torch

from foreride.detector.export.optimise_graph import rewrite
from foreride.detector.export.quantize import to_half_precision
from foreride.detector.export.to_onnx import to_onnx
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


def images(count: int) -> list[np.ndarray]:
    """Small synthetic roads."""
    rng = np.random.default_rng(1)
    return [draw(rng, 160, 160)[0] for _ in range(count)]


@pytest.mark.parametrize("name", ["sbp-yolo", "yolo11n"])
@pytest.mark.parametrize("join", [False, True])
def test_a_hundred_images_give_equal_outputs(name: str, join: bool) -> None:
    plain = to_onnx(network(name), {"names": "a"}, published=True)
    before, after = runner(plain), runner(rewrite(to_onnx(network(name), {"names": "a"}), join))
    made_up = images(100)
    assert max(np.ptp(before(i)[1]) for i in made_up) > 1e-2  # the scores differ enough for an error to show
    assert max(difference(before(i), after(i), 160) for i in made_up) <= 1e-5


def test_less_is_convolved_and_nothing_is_shuffled_or_copied() -> None:
    before = to_onnx(network("sbp-yolo"), {})
    after = rewrite(before)

    def count(model, kind: str) -> int:
        return sum(n.op_type == kind for n in model.graph.node)

    assert count(after, "Split") < count(before, "Split")
    assert not any("Concat" in n.op_type and "/top" in n.name for n in after.graph.node)
    shuffles = [n for n in after.graph.node if n.op_type == "Transpose" and len(n.attribute[0].ints) == 5]
    assert not shuffles
    assert len(after.graph.node) < len(before.graph.node)


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
