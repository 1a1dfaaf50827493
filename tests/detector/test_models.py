"""The network against the figures of the paper (arXiv 2508.01339, Table 1)."""

import pytest

pytest.importorskip("torch")

import torch
from torch.utils.flop_counter import FlopCounterMode

from detector.blocks import C2PSA, SPPF, C3k2, GhostConv, GSConv, VoVGSCSPC
from detector.heads import anchor_points
from detector.models import STRIDES, SbpYolo, count_parameters


def test_has_the_parameters_of_the_paper_without_its_dead_convolution() -> None:
    # 2.048 M counted in the released code, 0.369 M of them in a 3x3 convolution that is never run
    assert count_parameters(SbpYolo()) == pytest.approx(1.678e6, rel=0.001)


@pytest.mark.parametrize(("width", "paper"), [(0.25, 5.8), (0.5, 20.6)])
def test_has_the_operations_of_the_paper(width: float, paper: float) -> None:
    model = SbpYolo(width).eval()
    with torch.no_grad(), FlopCounterMode(display=False) as counter:
        found = model(torch.zeros(1, 3, 320, 320))
        everywhere = torch.arange(found.class_logits.shape[1])
        found.box_logits(torch.zeros_like(everywhere), everywhere)
    at_640 = 4 * counter.get_total_flops()  # but for the attention, which is 1 % of all
    assert at_640 / 1e9 == pytest.approx(paper, rel=0.03)


@pytest.mark.parametrize(("height", "width"), [(64, 96), (192, 320)])
def test_maps_have_the_strides_of_the_levels(height: int, width: int) -> None:
    model = SbpYolo().eval()
    with torch.no_grad():
        maps = model.pyramid(torch.zeros(2, 3, height, width))
        found = model.head(maps)
    assert [m.shape[2:] for m in maps] == [(height // s, width // s) for s in STRIDES]
    points = len(anchor_points(height, width, STRIDES)[0])
    assert found.class_logits.shape == (2, points, 2)
    assert found.box_logits(torch.tensor([0, 1]), torch.tensor([0, points - 1])).shape == (2, 64)


BLOCKS = [GhostConv(32, 64, 3, 2), C3k2(32, 64), VoVGSCSPC(32, 64), C3k2(32, 64, 0.25)]


@pytest.mark.parametrize("block", BLOCKS)
def test_blocks_give_the_channels_asked_for(block: torch.nn.Module) -> None:
    assert block(torch.zeros(2, 32, 8, 8)).shape[1] == 64


@pytest.mark.parametrize("block", [SPPF(128), C2PSA(128)])
def test_blocks_that_keep_their_shape(block: torch.nn.Module) -> None:
    assert block(torch.zeros(2, 128, 8, 8)).shape == (2, 128, 8, 8)


@pytest.mark.parametrize("channels", [128, 256])
def test_ghost_convolution_costs_about_half(channels: int) -> None:
    # eq. 4: (k_m² + k_c² / c_1) / 2k² is 48-55 % for 64-256 channels, k_m 3, k_c 5
    block = GhostConv(channels, channels, 3)
    ghost = sum(m.weight.numel() for m in block.modules() if isinstance(m, torch.nn.Conv2d))
    assert 0.48 < ghost / (9 * channels**2) < 0.55


def test_shuffle_puts_even_channels_before_odd_ones() -> None:
    block = GSConv(4, 8, 1).eval()
    x = torch.randn(1, 4, 3, 3)
    with torch.no_grad():
        primary = block.primary(x)
        plain = torch.cat((primary, block.cheap(primary)), 1)
        assert torch.equal(block(x), torch.cat((plain[:, 0::2], plain[:, 1::2]), 1))


def test_class_scores_start_near_the_frequency_of_objects() -> None:
    model = SbpYolo().eval()
    with torch.no_grad():
        found = model(torch.zeros(1, 3, 64, 64))
    assert found.class_logits.sigmoid().max() < 0.02


def test_the_box_branch_asked_for_points_is_the_convolution() -> None:
    torch.manual_seed(0)
    head = SbpYolo().eval().head
    maps = [torch.randn(2, c, 64 // s, 96 // s) for c, s in zip((32, 64, 128, 256), STRIDES, strict=True)]
    with torch.no_grad():
        found = head(maps)
        dense = [branch(shared(x)) for branch, shared, x in zip(head.box, head.shared, maps, strict=True)]
        rows = torch.cat([d.permute(0, 2, 3, 1).flatten(1, 2) for d in dense], 1)
        image, point = torch.randint(2, (50,)), torch.randint(rows.shape[1], (50,))
        assert torch.allclose(found.box_logits(image, point), rows[image, point], atol=1e-5)
