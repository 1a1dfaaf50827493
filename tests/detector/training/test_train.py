"""Training: repeatable batches, exact resume, and a falling loss."""

import json
from pathlib import Path

import pytest

pytest.importorskip("torch")
import torch

from foreride.detector.data.yolo_folder import read_samples
from foreride.detector.network.checkpoint import load, load_weights, save_weights
from foreride.detector.network.models import Network, build
from foreride.detector.training.batches import batches, make_batch
from foreride.detector.training.schedule import parse_stages
from foreride.detector.training.train import main
from foreride.detector.training.trainer import Settings, Trainer, validate
from foreride.files.errors import InputError
from tests.detector.roads import write

CPU = torch.device("cpu")


def settings(stages: str) -> Settings:
    return Settings(parse_stages(stages), batch=2, warmup=4, precision="fp32")


def same(a: dict, b: dict) -> bool:
    return a.keys() == b.keys() and all(torch.equal(a[k], b[k]) for k in a)


def test_batches_depend_on_seed_and_position_only(tmp_path: Path) -> None:
    samples = list(read_samples(write(tmp_path / "data", 5)))
    stages = parse_stages("96x64:12")
    ahead = [b.images for b in batches(samples, stages, 4, 0, 3, workers=2)]
    assert len(ahead) == 3
    for i, images in enumerate(ahead):
        assert torch.equal(images, make_batch(samples, stages[0], 4, 4 * i, 3).images)
    resumed = next(batches(samples, stages, 4, 8, 3, workers=1))
    assert torch.equal(resumed.images, ahead[2])
    assert not torch.equal(make_batch(samples, stages[0], 4, 0, 4).images, ahead[0])


def test_an_epoch_shows_every_image_once(tmp_path: Path) -> None:
    samples = list(read_samples(write(tmp_path / "data", 6)))
    shown = []
    original = "foreride.detector.training.batches.training_view"
    with pytest.MonkeyPatch.context() as patch:
        from foreride.detector.training.batches import training_view

        patch.setattr(original, lambda s, i, *a: (shown.append(s[i].name), training_view(s, i, *a))[1])
        for start in (0, 3):
            make_batch(samples, parse_stages("96x64:12")[0], 3, start, 0)
    assert sorted(shown) == [s.name for s in samples]


def test_resumed_training_is_bit_equal_to_an_unbroken_one(tmp_path: Path) -> None:
    samples = list(read_samples(write(tmp_path / "data", 4)))
    stages = "96x64:4,128x96:4"

    def advance(trainer: Trainer, steps: int) -> None:
        feed = batches(samples, trainer.settings.stages, 2, trainer.passes, 0, 1)
        for _, batch in zip(range(steps), feed, strict=False):
            trainer.step(batch)

    uninterrupted = Trainer(settings(stages), CPU)
    advance(uninterrupted, 4)
    first = Trainer(settings(stages), CPU)
    advance(first, 2)
    first.save(tmp_path / "checkpoint.pt")
    second = Trainer(settings(stages), CPU)
    second.restore(tmp_path / "checkpoint.pt")
    advance(second, 2)
    assert second.passes == uninterrupted.passes == 8
    assert same(second.model.state_dict(), uninterrupted.model.state_dict())
    assert same(second.average.model.state_dict(), uninterrupted.average.model.state_dict())


def test_command_trains_writes_and_resumes(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    write(tmp_path / "data" / "train", 4, 0)
    write(tmp_path / "data" / "val", 2, 1)
    run = tmp_path / "run"
    words = ["--data", str(tmp_path / "data"), "--out", str(run), "--batch", "2", "--threads", "1"]
    words += ["--validate-every", "4", "--precision", "fp32"]
    assert main([*words, "--stages", "96x64:4"]) == 0
    history = [json.loads(line) for line in (run / "history.jsonl").read_text().splitlines()]
    assert [row["passes"] for row in history] == [4, 4]
    made = load_weights(run / "weights.pt", Network())
    assert made["passes"] == 4
    assert main([*words, "--stages", "96x64:4"]) == 2
    assert "add --resume" in capsys.readouterr().err
    assert main([*words, "--stages", "96x64:6", "--resume"]) == 0
    assert load_weights(run / "weights.pt", Network())["passes"] == 6
    start = ["--stages", "96x64:2", "--init", str(run / "weights.pt")]
    assert main([*words[:3], str(tmp_path / "other"), *words[4:], *start]) == 0


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--nwd-alpha", "2"], "nwd_alpha must lie in 0 ... 1, got 2.0"),
        (["--edge-weight", "-1"], "edge must lie in 0 ... 1000000, got -1.0"),
        (["--mosaic", "1.1"], "mosaic must lie in 0 ... 1, got 1.1"),
        (["--weather", "nan"], "weather must lie in 0 ... 1, got nan"),
        (["--stages", "100x64:4"], "multiples of 32"),
        (["--data", "nowhere"], "nowhere/train: no folder images/"),
        (["--init", "nowhere.pt"], "nowhere.pt: no such file"),
        (["--batch", "0"], "--batch must be >= 1, got 0"),
        (["--rate", "0"], "--rate must be finite and > 0, got 0"),
        (["--rate", "inf"], "--rate must be finite and > 0, got inf"),
        (["--patience", "-1"], "--patience must be finite and >= 0, got -1"),
        (["--seed", "-1"], "--seed must be finite and >= 0, got -1"),
        (["--distil-logits", "-1"], "--distil-logits must be finite and >= 0, got -1"),
        (["--distil-features", "nan"], "--distil-features must be finite and >= 0, got nan"),
        (["--validate-every", "0"], "--validate-every must be >= 1, got 0"),
        (["--resume"], "run/checkpoint.pt: no such file"),
        (["--device", "tpu"], "--device must be auto, cpu or cuda"),
    ],
)
def test_bad_options_are_told_in_one_line_and_leave_nothing(
    tmp_path: Path, capsys: pytest.CaptureFixture, options: list[str], message: str
) -> None:
    write(tmp_path / "data" / "train", 2)
    write(tmp_path / "data" / "val", 1)
    words = ["--data", str(tmp_path / "data"), "--out", str(tmp_path / "run"), "--stages", "96x64:4"]
    assert main([*words, "--threads", "1", *options]) == 2
    printed = capsys.readouterr().err
    assert message in printed
    assert printed.count("\n") == 1
    assert not (tmp_path / "run").exists()


def test_a_run_of_another_model_is_not_resumed(tmp_path: Path) -> None:
    Trainer(settings("96x64:4"), CPU).save(tmp_path / "checkpoint.pt")
    yolo11n = Trainer(Settings(parse_stages("96x64:4"), "yolo11n"), CPU)
    with pytest.raises(InputError, match=r"model must be sbp-yolo, with or without a teacher"):
        yolo11n.restore(tmp_path / "checkpoint.pt")


@pytest.mark.parametrize("content", [None, b"", b"junk"])
def test_unreadable_weights_are_named(tmp_path: Path, content: bytes | None) -> None:
    path = tmp_path / "w.pt"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(InputError, match=r"w\.pt: "):
        load(path, ("weights",))


def test_weights_of_another_width_are_named(tmp_path: Path) -> None:
    path = tmp_path / "w.pt"
    save_weights(path, build("sbp-yolo-s"), {"model": "sbp-yolo-s"})
    with pytest.raises(InputError, match="weights of model sbp-yolo-s do not fit"):
        load_weights(path, Network())


def test_weights_for_other_classes_are_named(tmp_path: Path) -> None:
    path = tmp_path / "w.pt"
    save_weights(path, build("sbp-yolo"), {"names": ["pothole", "speed_bump"]})
    with pytest.raises(
        InputError, match=r"w\.pt: classes must be speed_bump, pothole, got \['pothole', 'speed_bump'\]"
    ):
        load_weights(path, Network())


@pytest.mark.slow
def test_learns_a_few_images_by_heart(tmp_path: Path) -> None:
    samples = list(read_samples(write(tmp_path / "data", 8)))
    stages = parse_stages("128x96:2400")
    trainer = Trainer(Settings(stages, batch=8, warmup=100, precision="fp32"), CPU)
    for batch in batches(samples, stages, 8, 0, 0, 1):
        trainer.step(batch)
    assert validate(trainer, samples, stages[0])["map50"] > 0.95
