"""Whole short trainings: the same twice over, the same when broken off and resumed, stopped when stalled."""

import json
import os
import signal
from pathlib import Path

import pytest

pytest.importorskip("torch")
import torch

from detector.checkpoint import load
from detector.train import main
from detector.trainer import Trainer
from tests.detector.roads import write

WORDS = ["--batch", "2", "--threads", "1", "--validate-every", "4", "--mosaic", "0.5", "--weather", "0.5"]
PASSES = 12


@pytest.fixture
def data(tmp_path: Path) -> Path:
    write(tmp_path / "data" / "train", 5, 0)
    write(tmp_path / "data" / "val", 2, 1)
    return tmp_path / "data"


def trained(data: Path, out: Path, *more: str) -> dict[str, torch.Tensor]:
    """The weights after the command, run in the precision of real trainings."""
    words = ["--data", str(data), "--out", str(out), "--stages", f"96x64:{PASSES}", *WORDS, *more]
    assert main(words) == 0
    return load(out / "weights.pt", ("weights",))["weights"]


def test_the_seed_decides_every_bit(data: Path, tmp_path: Path) -> None:
    one, two = (trained(data, tmp_path / name) for name in ("one", "two"))
    other = trained(data, tmp_path / "other", "--seed", "1")
    assert one.keys() == two.keys()
    assert all(torch.equal(one[key], two[key]) for key in one)
    assert not all(torch.equal(one[key], other[key]) for key in one)
    assert (tmp_path / "one" / "history.jsonl").read_text() == (
        tmp_path / "two" / "history.jsonl"
    ).read_text()


@pytest.mark.parametrize("which", [signal.SIGINT, signal.SIGTERM])
def test_a_run_broken_off_and_resumed_ends_as_an_unbroken_one(
    data: Path, tmp_path: Path, which: signal.Signals, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = trained(data, tmp_path / "whole")
    step = Trainer.step

    def interrupted(self: Trainer, batch) -> torch.Tensor:
        terms = step(self, batch)
        if self.passes == 6:
            os.kill(os.getpid(), which)
        return terms

    before = signal.getsignal(which)
    with monkeypatch.context() as patch:
        patch.setattr(Trainer, "step", interrupted)
        with pytest.raises(SystemExit, match="stopped after 6 passes; go on with --resume"):
            trained(data, tmp_path / "broken")
    assert signal.getsignal(which) == before
    assert not (tmp_path / "broken" / "weights.pt").exists()
    resumed = trained(data, tmp_path / "broken", "--resume")
    assert all(torch.equal(whole[key], resumed[key]) for key in whole)


def test_stops_early_when_nothing_gets_better(
    data: Path, tmp_path: Path, capsys: pytest.CaptureFixture
) -> None:
    trained(data, tmp_path / "run", "--patience", "1", "--validate-every", "2", "--rate", "1e-9")
    assert "no better mAP50-95 in 1 validations" in capsys.readouterr().out
    rows = [json.loads(line) for line in (tmp_path / "run" / "history.jsonl").read_text().splitlines()]
    assert [row["passes"] for row in rows] == [2, 4, 4]
