"""Terms of the detection loss in closed form."""

import math

import pytest

pytest.importorskip("torch")

import torch

from foreride.detector.network.heads import BINS, ROW_BINS, Predictions, anchor_points, encode
from foreride.detector.training.assigner import GroundTruth, assign
from foreride.detector.training.losses import LossWeights, detection_loss, distribution_focal_loss, edge_loss

POINTS, STRIDE = anchor_points(96, 128, (4, 8, 16, 32))


def everywhere(box_logits: torch.Tensor, class_logits: torch.Tensor) -> Predictions:
    """Predictions with these logits, (B, N, 64) and (B, N, classes): an identity for a branch."""
    branch = torch.nn.Conv2d(64, 64, 1, bias=False)
    branch.weight.data = torch.eye(64)[..., None, None]
    return Predictions(class_logits, [box_logits], [branch])


def blank() -> Predictions:
    return everywhere(torch.zeros(1, len(POINTS), 64), torch.zeros(1, len(POINTS), 2))


def truth_of(cls: int, box: list[float]) -> GroundTruth:
    return GroundTruth(torch.tensor([0]), torch.tensor([cls]), torch.tensor([box]))


def no_truth() -> GroundTruth:
    return GroundTruth(torch.zeros(0, dtype=torch.long), torch.zeros(0, dtype=torch.long), torch.zeros(0, 4))


def test_distribution_loss_is_the_entropy_between_two_bins() -> None:
    target = torch.tensor([[2.25, 3.0, 0.0, 14.5]])
    loss = distribution_focal_loss(torch.zeros(1, 4 * BINS), target)
    assert loss.item() == pytest.approx(math.log(BINS), rel=1e-5)
    sharp = torch.full((4, BINS), -1e4)
    sharp[range(4), [2, 3, 0, 14]] = math.log(0.75)
    sharp[range(4), [3, 4, 1, 15]] = math.log(0.25)
    sides = [0.75, 1.0, 1.0, 0.5]  # share of the lower bin
    by_hand = [-s * math.log(0.75) - (1 - s) * math.log(0.25) for s in sides]
    loss = distribution_focal_loss(sharp.reshape(1, -1), target)
    assert loss.item() == pytest.approx(sum(by_hand) / 4, rel=1e-4)


def test_an_empty_road_teaches_classes_only() -> None:
    predictions = blank()
    box, label, distribution, edge = detection_loss(predictions, no_truth(), POINTS, STRIDE, LossWeights())
    assert box == distribution == edge == 0
    assert label.item() == pytest.approx(0.5 * len(POINTS) * 2 * math.log(2), rel=1e-5)


def test_points_around_a_tiny_object_are_left_alone() -> None:
    predictions = blank()
    weights = LossWeights()
    everywhere = detection_loss(predictions, no_truth(), POINTS, STRIDE, weights)[1]
    spared = detection_loss(predictions, truth_of(-1, [0, 0, 128, 96]), POINTS, STRIDE, weights)
    assert spared.sum() == 0
    partly = detection_loss(predictions, truth_of(-1, [40, 40, 44, 41]), POINTS, STRIDE, weights)[1]
    assert 0.9 * everywhere < partly < everywhere


def certain(box: torch.Tensor) -> torch.Tensor:
    """Logits (1, N, 64) with which every point predicts this box."""
    side = encode(box.expand(len(POINTS), 4), POINTS, STRIDE)
    lower = side.floor().long()
    share = torch.zeros(len(POINTS), 4, BINS).scatter(2, lower[..., None], (lower + 1 - side)[..., None])
    share = share.scatter(2, lower[..., None] + 1, (side - lower)[..., None])
    return share.clamp(min=1e-30).log().reshape(1, -1, 64)


@pytest.mark.parametrize("alpha", [1.0, 0.5, 0.0])
def test_a_perfect_box_has_no_box_loss(alpha: float) -> None:
    box = torch.tensor([40.0, 32.0, 88.0, 64.0])
    predictions = everywhere(certain(box), torch.zeros(1, len(POINTS), 2))
    weights = LossWeights(nwd_alpha=alpha, edge=1.0)
    terms = detection_loss(predictions, truth_of(1, box.tolist()), POINTS, STRIDE, weights)
    assert terms[0].item() == pytest.approx(0, abs=2e-3)
    assert terms[3].item() == pytest.approx(0, abs=1e-3)


def test_edge_loss_counts_rows_in_strides() -> None:
    target = torch.tensor([[10.0, 20.0, 90.0, 40.0]] * 2)
    guess = torch.tensor([[0.0, 18.0, 99.0, 43.0], [10.0, 21.0, 90.0, 40.0]])
    loss = edge_loss(guess, target, torch.tensor([4.0, 16.0]))
    assert loss.tolist() == pytest.approx([(2 + 3) / 4, 1 / 16])


@pytest.mark.parametrize("too_tall", [1.0, 3.0, -2.0])
def test_edge_term_pulls_top_and_bottom_alone_however_large_the_error(too_tall: float) -> None:
    box = torch.tensor([40.0, 32.0, 88.0, 64.0])
    drawn = box + torch.tensor([0.0, -too_tall, 0.0, too_tall])
    predictions = everywhere(certain(drawn), torch.zeros(1, len(POINTS), 2))
    logits = predictions.features[0].requires_grad_()
    weights = LossWeights(box=0, label=0, distribution=0, edge=5.0)
    truths = truth_of(0, box.tolist())
    term = detection_loss(predictions, truths, POINTS, STRIDE, weights)[3]
    (slope,) = torch.autograd.grad(term, logits)
    slope = slope.unflatten(2, (4, BINS))
    assert (slope[..., 0, :] == 0).all()
    assert (slope[..., 2, :] == 0).all()
    matched = assign(predictions, POINTS, STRIDE, truths)
    share = (matched.score / matched.score.sum())[:, None]
    # d|error|/d(distance in strides) is the sign of the error; d(distance)/d(logit k) = p_k (bin_k - mean)
    p = logits.detach()[0].unflatten(1, (4, BINS)).softmax(2)[matched.anchor]
    bins = torch.tensor(ROW_BINS)
    for side in (1, 3):
        spread = p[:, side] * (bins - (p[:, side] * bins).sum(1, keepdim=True))
        by_hand = 5 * math.copysign(1, too_tall) * share * spread
        torch.testing.assert_close(slope[0, matched.anchor, side], by_hand, atol=1e-4, rtol=1e-3)


def test_without_weight_the_edge_term_changes_nothing() -> None:
    torch.manual_seed(0)
    predictions = everywhere(torch.randn(1, len(POINTS), 64), torch.randn(1, len(POINTS), 2))
    truths = truth_of(0, [20, 30, 100, 42])
    without = detection_loss(predictions, truths, POINTS, STRIDE, LossWeights())
    weighted = detection_loss(predictions, truths, POINTS, STRIDE, LossWeights(edge=2.0))
    assert without[3] == 0
    assert weighted[3] > 0
    assert torch.equal(without[:3], weighted[:3])


def test_constants_out_of_range_are_refused() -> None:
    with pytest.raises(ValueError, match="nwd_alpha must lie in 0"):
        LossWeights(nwd_alpha=1.5)
    with pytest.raises(ValueError, match="nwd_scale must be > 0"):
        LossWeights(nwd_scale=0)
    with pytest.raises(ValueError, match="edge must lie in 0"):
        LossWeights(edge=-1)
