"""Task-aligned assignment: every object gets points, and ties are resolved as documented."""

import numpy as np
import pytest

pytest.importorskip("torch")

import torch
from hypothesis import given
from hypothesis import strategies as st

from foreride.detector.network.heads import Predictions, anchor_points, decode, encode
from foreride.detector.training.assigner import GroundTruth, assign, candidates, rank_in_group

STRIDES = (4, 8, 16, 32)
POINTS, STRIDE = anchor_points(384, 640, STRIDES)
DEVICES = ["cpu", *(["cuda"] if torch.cuda.is_available() else [])]


def truths(*rows: tuple[int, int, list[float]]) -> GroundTruth:
    image, classes, boxes = zip(*rows, strict=True)
    return GroundTruth(torch.tensor(image), torch.tensor(classes), torch.tensor(boxes, dtype=torch.float32))


def blank() -> tuple[torch.Tensor, torch.Tensor]:
    return torch.zeros(1, len(POINTS), 64), torch.zeros(1, len(POINTS), 2)


def everywhere(box_logits: torch.Tensor, class_logits: torch.Tensor) -> Predictions:
    """Predictions with these logits, (B, N, 64) and (B, N, classes): an identity for a branch."""
    branch = torch.nn.Conv2d(64, 64, 1, bias=False)
    branch.weight.data = torch.eye(64)[..., None, None]
    return Predictions(class_logits, [box_logits], [branch])


@given(st.floats(100, 360), st.floats(2, 8), st.floats(0, 100), st.floats(200, 540))
def test_a_wide_thin_bump_has_candidates_on_every_level(y: float, h: float, x: float, w: float) -> None:
    near = candidates(torch.tensor([[x, y, x + w, y + h]]), POINTS, STRIDE)[0]
    for stride in STRIDES:
        assert near[stride == STRIDE].any()


@given(st.floats(100, 360), st.floats(2, 8), st.floats(0, 100), st.floats(200, 540))
def test_a_wide_thin_bump_is_taught_to_some_point(y: float, h: float, x: float, w: float) -> None:
    matched = assign(everywhere(*blank()), POINTS, STRIDE, truths((0, 0, [x, y, x + w, y + h])))
    assert 1 <= len(matched.anchor) <= 10
    assert matched.score.max() > 0


@given(st.floats(2, 60), st.floats(200, 540))
def test_a_box_is_left_to_levels_with_rows_finer_than_it_is_high(h: float, w: float) -> None:
    matched = assign(everywhere(*blank()), POINTS, STRIDE, truths((0, 0, [50, 200, 50 + w, 200 + h])))
    assert STRIDE[matched.anchor].max() <= max(h, min(STRIDES))


def test_each_point_learns_one_object_of_its_own_image() -> None:
    wanted = truths((0, 0, [0, 100, 300, 110]), (0, 1, [100, 90, 140, 120]), (1, 1, [400, 300, 440, 310]))
    torch.manual_seed(0)
    guess = everywhere(torch.randn(2, len(POINTS), 64), torch.randn(2, len(POINTS), 2))
    matched = assign(guess, POINTS, STRIDE, wanted)
    where = (matched.image * len(POINTS) + matched.anchor).tolist()
    assert len(set(where)) == len(where)
    assert torch.equal(matched.image, wanted.image[matched.truth])
    assert set(matched.truth.tolist()) == {0, 1, 2}


def test_the_best_point_gets_the_best_overlap_as_its_score() -> None:
    wanted = truths((0, 1, [200, 150, 260, 210]))
    box_logits, class_logits = blank()
    matched = assign(everywhere(box_logits, class_logits), POINTS, STRIDE, wanted)
    assert 0 < matched.score.max() <= 1
    assert (matched.score >= 0).all()
    class_logits[0, matched.anchor[0], 1] = 5.0  # a point with a higher score is better aligned
    again = assign(everywhere(box_logits, class_logits), POINTS, STRIDE, wanted)
    assert again.score[again.anchor == matched.anchor[0]].item() == again.score.max()


def rough_guess(wanted: GroundTruth) -> Predictions:
    """Scores at random and, at each point, some object of its image with sides a few pixels off."""
    torch.manual_seed(1)
    logits = torch.empty(2, len(POINTS), 4, 16)
    for image in range(2):
        boxes = wanted.boxes[wanted.image == image]
        seen = boxes[torch.randint(len(boxes), (len(POINTS),))] + 2.0 * torch.randn(len(POINTS), 4)
        place = encode(seen, POINTS, STRIDE)[..., None]
        logits[image] = (1.0 - (place - torch.arange(16)).abs()).clamp(min=1e-9).log()
    return everywhere(logits.flatten(2), torch.randn(2, len(POINTS), 2))


def shared_area(a: list[float], b: list[float]) -> float:
    """Intersection over union of two boxes."""
    width, height = (max(0.0, min(a[i + 2], b[i + 2]) - max(a[i], b[i])) for i in (0, 1))
    areas = sum((box[2] - box[0]) * (box[3] - box[1]) for box in (a, b))
    return width * height / (areas - width * height)


def expected_pairs(guess: Predictions, wanted: GroundTruth) -> dict[tuple[int, int], tuple[int, float]]:
    """(image, point) -> (object, target) by TOOD's equation 1, object by object: the second implementation.

    alignment = score^0.5 · IoU^6; the ten best points of each object within one stride of it, on levels whose
    stride is at most 0.7 of its height, or the finest; a contested point goes to the greater overlap.
    """
    taken: dict[tuple[int, int], list[tuple[float, int, float]]] = {}
    for number, (image, cls, box) in enumerate(zip(wanted.image, wanted.classes, wanted.boxes, strict=True)):
        x0, y0, x1, y1 = box.tolist()
        inside = (POINTS[:, 0] > x0 - STRIDE) & (POINTS[:, 0] < x1 + STRIDE)
        inside &= (POINTS[:, 1] > y0 - STRIDE) & (POINTS[:, 1] < y1 + STRIDE)
        near = (inside & ((0.7 * (y1 - y0) >= STRIDE) | (STRIDE == 4))).nonzero()[:, 0]
        image_index = torch.full_like(near, int(image))
        boxes = decode(guess.box_logits(image_index, near), POINTS[near], STRIDE[near])
        overlap = torch.tensor([shared_area(each, box.tolist()) for each in boxes.tolist()])
        score = guess.class_logits[image, near, cls].sigmoid()
        alignment = score.sqrt() * overlap**6
        for k in alignment.argsort(descending=True)[:10]:
            entry = (float(overlap[k]), number, float(alignment[k]))
            taken.setdefault((int(image), int(near[k])), []).append(entry)
    kept = {place: max(entries) for place, entries in taken.items()}
    pairs = {}
    for place, (_, number, alignment) in kept.items():
        of_object = [entry for entry in kept.values() if entry[1] == number]
        best_overlap, best_alignment = (max(entry[i] for entry in of_object) for i in (0, 2))
        pairs[place] = (number, alignment / best_alignment * best_overlap)
    assert any(len({number for _, number, _ in entries}) > 1 for entries in taken.values()), "a contest"
    return pairs


def test_the_pairs_and_targets_are_those_of_the_publication() -> None:
    """Large, small and overlapping objects of two images, some of them at the limit of a coarser level."""
    rows = [(0, 0, [100, 90, 140, 120]), (0, 1, [104, 92, 146, 124]), (0, 0, [300, 200, 420, 209])]
    rows += [(1, 1, [10, 250, 200, 300]), (1, 0, [400, 300, 440, 311]), (1, 1, [401, 299, 441, 312])]
    wanted = truths(*rows)
    guess = rough_guess(wanted)
    expected = expected_pairs(guess, wanted)
    matched = assign(guess, POINTS, STRIDE, wanted)
    found = zip(matched.image.tolist(), matched.anchor.tolist(), strict=True)
    assert dict(zip(found, matched.truth.tolist(), strict=True)) == {
        place: number for place, (number, _) in expected.items()
    }
    places = zip(matched.image.tolist(), matched.anchor.tolist(), strict=True)
    np.testing.assert_allclose(matched.score, [expected[place][1] for place in places], rtol=1e-4)


def test_no_object_no_assignment() -> None:
    none = GroundTruth(torch.zeros(0, dtype=torch.long), torch.zeros(0, dtype=torch.long), torch.zeros(0, 4))
    assert len(assign(everywhere(*blank()), POINTS, STRIDE, none).anchor) == 0


@given(st.lists(st.tuples(st.integers(0, 3), st.sampled_from([0.0, 0.5, 1.0, 2.0])), max_size=30))
def test_rank_within_groups(pairs: list[tuple[int, float]]) -> None:
    group = torch.tensor([g for g, _ in pairs], dtype=torch.long)
    value = torch.tensor([v for _, v in pairs])
    expected = [
        sum(h == g and (w > v or (w == v and j < i)) for j, (h, w) in enumerate(pairs))
        for i, (g, v) in enumerate(pairs)
    ]
    assert rank_in_group(group, value).tolist() == expected


@pytest.mark.parametrize("device", DEVICES)
def test_every_device_assigns_the_same_points(device: str) -> None:
    """Among random predictions, and among blank ones, where ties decide."""
    wanted = truths((0, 0, [0, 100, 300, 110]), (0, 1, [100, 90, 140, 120]), (1, 1, [400, 300, 440, 310]))
    torch.manual_seed(0)
    for scale in (0.0, 1.0):
        logits = scale * torch.randn(2, len(POINTS), 64), scale * torch.randn(2, len(POINTS), 2)
        expected = assign(everywhere(*logits), POINTS, STRIDE, wanted)
        guess = everywhere(*(values.to(device) for values in logits))
        guess.branches[0].to(device)
        place = torch.device(device)
        matched = assign(guess, POINTS.to(place), STRIDE.to(place), wanted.to(place))
        for name in ("image", "anchor", "truth"):
            assert torch.equal(getattr(matched, name).cpu(), getattr(expected, name))
        torch.testing.assert_close(matched.score.cpu(), expected.score, rtol=1e-3, atol=1e-4)
