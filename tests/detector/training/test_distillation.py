"""Distillation terms in closed form, and a student that converges to its teacher."""

import math
from pathlib import Path

import pytest

pytest.importorskip("torch")

import torch

from foreride.detector.data.yolo_folder import read_samples
from foreride.detector.network.checkpoint import save_weights
from foreride.detector.network.heads import Predictions, anchor_points
from foreride.detector.network.models import build
from foreride.detector.training.assigner import GroundTruth
from foreride.detector.training.batches import make_batch
from foreride.detector.training.distillation import Distillation, DistillationWeights, FeatureAdapter, bckd
from foreride.detector.training.schedule import parse_stages
from foreride.detector.training.trainer import Settings, Trainer
from tests.detector.roads import write

POINTS, STRIDE = anchor_points(96, 128, (4, 8, 16, 32))
NONE = GroundTruth(torch.zeros(0, dtype=torch.long), torch.zeros(0, dtype=torch.long), torch.zeros(0, 4))


def saying(class_logits: torch.Tensor, box_logits: torch.Tensor) -> Predictions:
    """Predictions with these logits, through an identity branch."""
    branch = torch.nn.Conv2d(64, 64, 1, bias=False)
    branch.weight.data = torch.eye(64)[..., None, None]
    return Predictions(class_logits, [box_logits], [branch])


def test_class_term_of_the_logits_by_hand() -> None:
    n = len(POINTS)
    student, teacher = torch.full((1, n, 2), -30.0), torch.full((1, n, 2), -30.0)
    student[0, 0, 1], teacher[0, 0, 1] = 0.0, math.log(3.0)
    box, label = bckd(
        saying(student, torch.zeros(1, n, 64)), saying(teacher, torch.zeros(1, n, 64)), NONE, POINTS, STRIDE
    )
    # one point where the student says 1/2 and the teacher 3/4: BCE(0, 3/4) = ln 2, weighed by 1/4
    assert label.item() == pytest.approx(0.25 * math.log(2), abs=1e-5)
    assert box.item() == 0  # no object, no foreground


def test_box_term_vanishes_where_the_boxes_agree_and_is_weighed_by_the_doubt() -> None:
    n = len(POINTS)
    truth = GroundTruth(torch.tensor([0]), torch.tensor([0]), torch.tensor([[20.0, 20.0, 60.0, 50.0]]))
    sides, far = torch.zeros(1, n, 64), torch.zeros(1, n, 64)
    far[..., 4::16] = 5.0
    class_logits, unsure = torch.zeros(1, n, 2), torch.full((1, n, 2), math.log(3.0))
    same, _ = bckd(saying(class_logits, sides), saying(unsure, sides), truth, POINTS, STRIDE)
    apart, _ = bckd(saying(class_logits, sides), saying(unsure, far), truth, POINTS, STRIDE)
    class_term, _ = bckd(saying(class_logits, sides), saying(class_logits, far), truth, POINTS, STRIDE)
    assert same.item() == pytest.approx(0, abs=1e-5)
    assert apart.item() > 0.05
    assert class_term.item() == 0  # equal class scores: zero loss


def test_maps_of_other_widths_are_aligned() -> None:
    torch.manual_seed(0)
    aligned = FeatureAdapter((4, 8), (6, 8))
    maps = [torch.randn(2, c, 5, 7) for c in (4, 8)]
    others = [torch.randn(2, c, 5, 7) for c in (6, 8)]
    loss = aligned(maps, others)
    loss.backward()
    assert loss.item() > 0
    assert all(p.grad is not None for p in aligned.parameters())


@pytest.mark.parametrize(("logits", "features"), [(0.5, 0.0), (0.0, 0.5), (0.5, 0.5)])
def test_a_term_of_weight_zero_is_left_out(logits: float, features: float) -> None:
    torch.manual_seed(1)
    student, images = build("sbp-yolo"), torch.rand(1, 3, 96, 128)
    told = Distillation(student, build("sbp-yolo-s"), DistillationWeights(logits, features))
    terms = told(images, student(images), NONE, POINTS, STRIDE)
    terms.sum().backward()
    assert [term > 0 for term in terms] == [logits > 0, features > 0]
    assert all((p.grad is None) == (features == 0) for p in told.aligned.parameters())
    assert any(p.grad is not None for p in student.parameters())


def test_a_teacher_is_learnt_from_and_stays_as_it_is(tmp_path: Path) -> None:
    torch.manual_seed(3)
    master = build("sbp-yolo-s")
    save_weights(tmp_path / "teacher.pt", master, {"model": "sbp-yolo-s"})
    samples = list(read_samples(write(tmp_path / "data", 2)))
    stages = parse_stages("64x64:40")
    settings = Settings(stages, batch=2, warmup=2, precision="fp32")
    trainer = Trainer(settings, torch.device("cpu"), teacher=tmp_path / "teacher.pt")
    before = {k: v.clone() for k, v in trainer.distillation.teacher.state_dict().items()}
    batch = make_batch(samples, stages[0], 2, 0, 0)
    terms = [trainer.step(batch) for _ in range(8)]
    assert len(terms[0]) == 6
    assert terms[-1][5] < terms[0][5]  # the features come closer
    assert all(torch.equal(v, before[k]) for k, v in trainer.distillation.teacher.state_dict().items())
    trainer.save(tmp_path / "checkpoint.pt")
    again = Trainer(settings, torch.device("cpu"), teacher=tmp_path / "teacher.pt")
    again.restore(tmp_path / "checkpoint.pt")
    assert torch.equal(again.step(batch), trainer.step(batch))
