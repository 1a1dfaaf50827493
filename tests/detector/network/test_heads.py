"""Decoding of box distributions against hand computation."""

import pytest

pytest.importorskip("torch")

import torch
from hypothesis import given
from hypothesis import strategies as st

from foreride.detector.network.heads import BINS, COLUMN_BINS, ROW_BINS, anchor_points, decode, encode


def sharp(bins: tuple[int, int, int, int]) -> torch.Tensor:
    """Logits with the whole mass in one bin per side."""
    logits = torch.full((4, BINS), -1e4)
    logits[range(4), list(bins)] = 1e4
    return logits.flatten()


def test_decodes_a_certain_box() -> None:
    box = decode(sharp((1, 2, 3, 4)), torch.tensor([100.0, 50.0]), torch.tensor(8.0))
    # bins 1, 2, 3, 4 stand for 0, 1, 2, 3 strides
    assert box.tolist() == [100.0, 42.0, 116.0, 74.0]


def test_a_flat_distribution_is_its_mean() -> None:
    box = decode(torch.zeros(4 * BINS), torch.tensor([0.0, 0.0]), torch.tensor(4.0))
    column, row = (4 * sum(bins) / BINS for bins in (COLUMN_BINS, ROW_BINS))
    assert box.tolist() == pytest.approx([-column, -row, column, row])


def test_a_point_outside_a_thin_box_can_describe_it() -> None:
    box = torch.tensor([100.0, 60.0, 300.0, 63.0])
    point, stride = torch.tensor([200.0, 70.0]), torch.tensor(16.0)
    side = encode(box, point, stride)
    assert 0 < side[3] < 1  # the bottom lies above the point: between the bins -1 and 0


def test_the_finest_level_reaches_across_the_image() -> None:
    box, point = torch.tensor([0.0, 200.0, 640.0, 206.0]), torch.tensor([590.0, 202.0])
    side = encode(box, point, torch.tensor(4.0))
    assert side[0] < BINS - 1.01


_FAR = st.floats(-0.99, 149.0)
_NEAR = st.floats(-0.99, 13.9)


@given(st.tuples(_FAR, _NEAR, _FAR, _NEAR), st.sampled_from([4.0, 8.0, 16.0, 32.0]))
def test_encoding_undoes_decoding(sides: tuple[float, ...], stride: float) -> None:
    left, top, right, bottom = (s * stride for s in sides)
    point = torch.tensor([300.0, 200.0])
    box = torch.tensor([300 - left, 200 - top, 300 + right, 200 + bottom])
    target = encode(box, point, torch.tensor(stride))
    lower = target.floor().long()
    weights = torch.zeros(4, BINS).scatter(1, lower[:, None], (lower + 1 - target)[:, None])
    weights = weights.scatter(1, lower[:, None] + 1, (target - lower)[:, None])
    back = decode(weights.clamp(min=1e-30).log().flatten(), point, torch.tensor(stride))
    assert torch.allclose(back, box, atol=1e-2)


def test_points_are_cell_centres_row_by_row() -> None:
    points, stride = anchor_points(32, 64, (16, 32))
    assert points.tolist() == [
        *([x, y] for y in (8.0, 24.0) for x in (8.0, 24.0, 40.0, 56.0)),
        [16.0, 16.0],
        [48.0, 16.0],
    ]
    assert stride.tolist() == [16.0] * 8 + [32.0] * 2
