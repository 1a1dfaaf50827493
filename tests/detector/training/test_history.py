"""Training log of a run folder."""

import json
import sys
from pathlib import Path

import cv2
import pytest

pytest.importorskip("torch")
pytest.importorskip("tensorboard")
import torch
from tensorboard.backend.event_processing.event_accumulator import EventAccumulator

from foreride.detector.data.yolo_folder import read_samples
from foreride.detector.training.batches import make_batch
from foreride.detector.training.history import TrainingLog
from foreride.detector.training.schedule import parse_stages
from foreride.detector.training.trainer import Settings, Trainer
from tests.detector.roads import write

STAGES = parse_stages("96x64:8")


@pytest.fixture
def trainer() -> Trainer:
    return Trainer(Settings(STAGES, batch=2, precision="fp32"), torch.device("cpu"))


def test_events_hold_losses_metrics_and_pictures(tmp_path: Path, trainer: Trainer) -> None:
    samples = list(read_samples(write(tmp_path / "data", 3)))
    with TrainingLog(tmp_path, 0) as record:
        terms = trainer.step(make_batch(samples, STAGES[0], 2, 0, 0))
        record.step(trainer, terms)
        record.validation(trainer, samples, terms)
    events = EventAccumulator(str(tmp_path / "tensorboard")).Reload()
    (point,) = events.Scalars("loss/box")
    assert (point.step, point.value) == (2, pytest.approx(terms[0].item(), rel=1e-6))
    row = json.loads((tmp_path / "history.jsonl").read_text())
    assert row["loss"].keys() == {"box", "class", "distribution", "edge"}
    (event,) = events.Scalars("validation mean/recall")
    assert event.value == pytest.approx(row["recall"])
    assert len(events.Images("predictions")) == 1
    picture = cv2.imread(str(tmp_path / "predictions" / "00000002.png"))
    assert picture.shape[1] > 3 * 360


def test_a_resumed_run_forgets_the_events_after_its_checkpoint(tmp_path: Path, trainer: Trainer) -> None:
    for start, passes in ((0, (2, 4, 6)), (4, (6, 8))):
        with TrainingLog(tmp_path, start) as record:
            for trainer.passes in passes:
                record.steps = 0
                record.step(trainer, torch.full((4,), float(start)))
    events = EventAccumulator(str(tmp_path / "tensorboard")).Reload()
    assert [(e.step, e.value) for e in events.Scalars("loss/box")] == [(2, 0), (4, 0), (6, 4), (8, 4)]


def test_training_does_without_tensorboard_and_says_so(
    tmp_path: Path, trainer: Trainer, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
) -> None:
    monkeypatch.setitem(sys.modules, "torch.utils.tensorboard", None)
    with TrainingLog(tmp_path, 0) as record:
        record.step(trainer, torch.zeros(4))
    assert "needs the package tensorboard" in capsys.readouterr().out
    assert not (tmp_path / "tensorboard").exists()


def test_a_fresh_run_forgets_the_history_of_one_without_a_checkpoint(tmp_path: Path) -> None:
    history = tmp_path / "history.jsonl"
    history.write_text(json.dumps({"passes": 2}) + "\n" + '{"pass')
    TrainingLog(tmp_path, 0)
    assert history.read_text() == ""


@pytest.mark.parametrize(
    ("scores", "stalled"),
    [([0.1], False), ([0.1, 0.2, 0.1], False), ([0.1, 0.2, 0.1, 0.2], True), ([None, None, None], True)],
)
def test_patience_waits_for_the_best(tmp_path: Path, scores: list[float | None], stalled: bool) -> None:
    rows = (
        {"passes": 8 * k, "map50": score, "map50_95": score, "recall": score}
        for k, score in enumerate(scores)
    )
    lines = [json.dumps(row) for row in rows]
    record = TrainingLog(tmp_path, 0)
    record.history.write_text("\n".join(lines) + "\n")
    assert record.stalled(2) == stalled
