"""IoU, CIoU and NWD against closed forms."""

import math

import pytest

pytest.importorskip("torch")

import torch
from hypothesis import given
from hypothesis import strategies as st

from foreride.detector.network.iou import ciou, iou, nwd

edge = st.floats(0, 500, width=32)
size = st.floats(1, 300, width=32)
boxes = st.tuples(edge, edge, size, size).map(lambda b: torch.tensor([b[0], b[1], b[0] + b[2], b[1] + b[3]]))


def test_iou_of_two_halves() -> None:
    assert iou(torch.tensor([0.0, 0, 2, 1]), torch.tensor([1.0, 0, 3, 1])).item() == pytest.approx(1 / 3)


def test_ciou_by_hand() -> None:
    a, b = torch.tensor([0.0, 0, 4, 2]), torch.tensor([2.0, 1, 6, 5])
    overlap = 2 / (8 + 16 - 2)
    distance = (2**2 + 2**2) / (6**2 + 5**2)
    v = 4 / math.pi**2 * (math.atan(2) - math.atan(1)) ** 2
    expected = overlap - distance - v / (1 - overlap + v) * v
    assert ciou(a, b).item() == pytest.approx(expected, rel=1e-5)


def test_nwd_by_hand() -> None:
    a, b = torch.tensor([0.0, 0, 4, 2]), torch.tensor([3.0, 4, 9, 10])
    # The centres lie 4 and 6 apart, the sides differ by 2 and 4.
    squared = 4**2 + 6**2 + (2**2 + 4**2) / 4
    assert nwd(a, b, 12.8).item() == pytest.approx(math.exp(-math.sqrt(squared) / 12.8), rel=1e-5)


@given(boxes)
def test_equal_boxes_are_wholly_alike(box: torch.Tensor) -> None:
    for likeness in (iou(box, box), ciou(box, box), nwd(box, box, 12.8)):
        assert likeness.item() == pytest.approx(1, abs=1e-4)


@given(boxes, boxes)
def test_likeness_is_symmetric_and_bounded(a: torch.Tensor, b: torch.Tensor) -> None:
    for measure, low in ((iou, 0.0), (ciou, -1.5), (lambda x, y: nwd(x, y, 12.8), 0.0)):
        value = measure(a, b).item()
        assert value == pytest.approx(measure(b, a).item(), abs=1e-5)
        assert low <= value <= 1 + 1e-5


def test_inside_out_guess_overlaps_nothing() -> None:
    guess = torch.tensor([10.0, 10, 5, 20], requires_grad=True)
    likeness = ciou(guess, torch.tensor([0.0, 0, 20, 20]))
    likeness.backward()
    assert likeness.item() < 0
    assert torch.isfinite(guess.grad).all()
