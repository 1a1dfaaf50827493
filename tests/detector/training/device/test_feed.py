"""Batches made on the device: repeatable, resumable, at the stated shares, trained on by the same command."""

from pathlib import Path

import pytest

pytest.importorskip("torch")
import torch

from foreride.detector.network.checkpoint import load
from foreride.detector.training.device.feed import DeviceAugmentation, DeviceFeed
from foreride.detector.training.mixture import Mixture
from foreride.detector.training.schedule import parse_stages
from foreride.detector.training.train import main
from tests.detector.roads import made, write

CPU = torch.device("cpu")
STAGES = parse_stages("96x64:8,64x64:8")


def feed(style: float = 0.5) -> DeviceFeed:
    mixture = Mixture([[made(seed) for seed in range(6)], [made(9)]], [0.25])
    return DeviceFeed(mixture, CPU, 3, DeviceAugmentation(1.4, style))


def test_batches_are_a_function_of_their_place() -> None:
    whole, resumed = list(feed().batches(STAGES, 4, 0)), list(feed().batches(STAGES, 4, 8))
    assert [tuple(batch.images.shape) for batch in whole] == [(4, 3, 64, 96)] * 2 + [(4, 3, 64, 64)] * 2
    for one, two in zip(whole[2:], resumed, strict=True):
        assert torch.equal(one.images, two.images)
        assert torch.equal(one.truths.boxes, two.truths.boxes)
        assert one.passes == two.passes


def test_objects_belong_to_images_of_the_batch() -> None:
    for batch in feed().batches(STAGES, 4, 0):
        assert batch.truths.image.max() < 4
        assert len(batch.truths.image) == len(batch.truths.classes) == len(batch.truths.boxes)
        assert batch.truths.classes.min() >= -1
        assert batch.images.is_contiguous(memory_format=torch.channels_last)


def test_the_command_trains_on_device_views_and_the_seed_decides_every_bit(tmp_path: Path) -> None:
    for name, count, seed in (("data/train", 4, 0), ("data/val", 2, 1), ("photographs", 3, 2)):
        write(tmp_path / name, count, seed)
    words = [
        "--data",
        str(tmp_path / "data"),
        "--mix",
        f"{tmp_path / 'photographs'}=0.4",
        "--views",
        "device",
    ]
    words += [
        "--stages",
        "96x64:4,64x64:4",
        "--batch",
        "2",
        "--threads",
        "1",
        "--device",
        "cpu",
        "--zoom",
        "2",
    ]
    weights = []
    for name in ("one", "two"):
        assert main([*words, "--out", str(tmp_path / name)]) == 0
        weights.append(load(tmp_path / name / "weights.pt", ("weights",))["weights"])
    assert all(torch.equal(weights[0][key], weights[1][key]) for key in weights[0])


@pytest.mark.parametrize(
    ("more", "message"),
    [
        (["--views", "device", "--mosaic", "0.5"], "--mosaic: device views have none"),
        (["--views", "device", "--zoom", "0"], "zoom must lie in 1 ... 8"),
        (["--views", "host", "--grow"], "--grow: must come with --views device"),
        (["--mix", "folder"], "--mix must be DIR=SHARE"),
        (["--mix", "folder=lots"], "--mix must be DIR=SHARE"),
        (["--mix", "absent=0.5"], "absent: no folder images/"),
    ],
)
def test_options_that_do_not_go_together_are_refused(
    tmp_path: Path, more: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in ("train", "val"):
        write(tmp_path / "data" / name, 2)
    words = ["--data", str(tmp_path / "data"), "--out", str(tmp_path / "out"), "--stages", "64x64:2"]
    assert main([*words, "--threads", "1", *more]) == 2
    assert message in capsys.readouterr().err
