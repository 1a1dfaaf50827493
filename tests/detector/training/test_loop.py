"""Whole short trainings: repeatable, identical after interruption and resume, stopped when stalled."""

import json
import os
import signal
from pathlib import Path

import pytest

pytest.importorskip("torch")
import torch

from foreride.detector.network.checkpoint import load
from foreride.detector.training.history import TrainingLog
from foreride.detector.training.train import main
from foreride.detector.training.trainer import Trainer
from tests.detector.roads import write

WORDS = ["--batch", "2", "--threads", "1", "--validate-every", "4", "--mosaic", "0.5", "--weather", "0.5"]
PASSES = 12


@pytest.fixture
def data(tmp_path: Path) -> Path:
    write(tmp_path / "data" / "train", 5, 0)
    write(tmp_path / "data" / "val", 2, 1)
    return tmp_path / "data"


def trained(data: Path, out: Path, *more: str) -> dict[str, torch.Tensor]:
    """Weights after the command, run in the precision of real trainings."""
    words = ["--data", str(data), "--out", str(out), "--stages", f"96x64:{PASSES}", *WORDS, *more]
    assert main(words) == 0
    return load(out / "weights.pt", ("weights",))["weights"]


def rows(run: Path) -> list[dict]:
    return [json.loads(line) for line in (run / "history.jsonl").read_text().splitlines()]


def test_the_seed_decides_every_bit(data: Path, tmp_path: Path) -> None:
    first, second = (trained(data, tmp_path / name) for name in ("one", "two"))
    other = trained(data, tmp_path / "other", "--seed", "1")
    assert first.keys() == second.keys()
    assert all(torch.equal(first[key], second[key]) for key in first)
    assert not all(torch.equal(first[key], other[key]) for key in first)
    assert (tmp_path / "one" / "history.jsonl").read_text() == (
        tmp_path / "two" / "history.jsonl"
    ).read_text()


@pytest.mark.parametrize("which", [signal.SIGINT, signal.SIGTERM])
def test_a_run_broken_off_and_resumed_ends_as_an_unbroken_one(
    data: Path, tmp_path: Path, which: signal.Signals, monkeypatch: pytest.MonkeyPatch
) -> None:
    uninterrupted = trained(data, tmp_path / "whole")
    step = Trainer.step

    def interrupted(self: Trainer, batch) -> torch.Tensor:
        terms = step(self, batch)
        if self.passes == 6:
            os.kill(os.getpid(), which)
        return terms

    before = signal.getsignal(which)
    with monkeypatch.context() as patch:
        patch.setattr(Trainer, "step", interrupted)
        with pytest.raises(SystemExit, match="stopped after 6 passes; continue with --resume"):
            trained(data, tmp_path / "broken")
    assert signal.getsignal(which) == before
    assert not (tmp_path / "broken" / "weights.pt").exists()
    history = tmp_path / "broken" / "history.jsonl"
    later = json.dumps({"passes": 8, "map50_95": 1.0})  # of steps made after the checkpoint, then half a line
    history.write_text(f"{history.read_text()}{later}\n{later[:9]}")
    resumed = trained(data, tmp_path / "broken", "--resume")
    assert all(torch.equal(uninterrupted[key], resumed[key]) for key in uninterrupted)
    assert [row["passes"] for row in rows(tmp_path / "broken")] == [4, 8, 12, 12]
    scores = [[row["map50_95"] for row in rows(tmp_path / name)] for name in ("whole", "broken")]
    assert scores[0] == scores[1]


def test_an_interrupt_while_the_last_validation_of_patience_runs_is_heeded(
    data: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    validation = TrainingLog.validation

    def interrupted(self: TrainingLog, trainer: Trainer, *rest) -> None:
        validation(self, trainer, *rest)
        if trainer.passes == 4:
            os.kill(os.getpid(), signal.SIGINT)

    monkeypatch.setattr(TrainingLog, "validation", interrupted)
    with pytest.raises(SystemExit, match="stopped after 4 passes; continue with --resume"):
        trained(data, tmp_path / "run", "--patience", "1", "--validate-every", "2", "--rate", "1e-9")
    assert not (tmp_path / "run" / "weights.pt").exists()


def test_a_finished_run_taken_up_again_tells_of_no_loss(data: Path, tmp_path: Path) -> None:
    before = trained(data, tmp_path / "run")
    after = trained(data, tmp_path / "run", "--resume")
    assert all(torch.equal(before[key], after[key]) for key in before)
    history = rows(tmp_path / "run")
    assert [("loss" in row) for row in history] == [True] * 4 + [False]


def test_weights_are_kept_where_the_curves_cannot_be_drawn(
    data: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def broken(run: Path) -> None:
        raise OSError("no space left")

    monkeypatch.setattr("foreride.detector.training.train.write_curves", broken)
    with pytest.raises(OSError, match="no space left"):
        trained(data, tmp_path / "run")
    assert (tmp_path / "run" / "weights.pt").exists()


def test_stops_early_when_nothing_gets_better(
    data: Path, tmp_path: Path, capsys: pytest.CaptureFixture
) -> None:
    trained(data, tmp_path / "run", "--patience", "1", "--validate-every", "2", "--rate", "1e-9")
    assert "no better mAP50-95 in 1 validations" in capsys.readouterr().out
    assert [row["passes"] for row in rows(tmp_path / "run")] == [2, 4, 4]
