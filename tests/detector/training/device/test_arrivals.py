"""Data sets that grow while a detector trains on them: new images are taken in once, and faults are told."""

import shutil
import time
from collections.abc import Set
from pathlib import Path

import pytest

pytest.importorskip("torch")
import torch

from foreride.detector.data.yolo_folder import Sample, read_samples
from foreride.detector.training.device import feed as feed_module
from foreride.detector.training.device.arrivals import Arrivals
from foreride.detector.training.device.feed import DeviceAugmentation, DeviceFeed
from foreride.detector.training.device.pool import NONE, joined, load_pool
from foreride.detector.training.image_store import CachedDataset, load_cached_dataset
from foreride.detector.training.mixture import Mixture
from foreride.detector.training.schedule import parse_stages
from foreride.detector.training.train import main
from foreride.files.errors import InputError
from tests.detector.roads import made, write

CPU = torch.device("cpu")


def _awaited(arrivals: Arrivals, count: int) -> list[Sample]:
    samples: list[Sample] = []
    deadline = time.monotonic() + 20
    while len(samples) < count and time.monotonic() < deadline:
        samples += arrivals.taken()
        time.sleep(0.01)
    return samples


def test_each_image_arrives_once(tmp_path: Path) -> None:
    write(tmp_path / "more", 5)
    tmp_path = write(tmp_path / "set", 2)
    first = {path.name for path in (tmp_path / "images").iterdir()}
    with Arrivals(tmp_path, lambda only: list(read_samples(tmp_path, only=only)), first, 0.01) as arrivals:
        assert arrivals.taken() == []
        for part in ("labels", "images"):
            for path in (tmp_path.parent / "more" / part).iterdir():
                shutil.copy(path, tmp_path / part)
        names = [sample.name for sample in _awaited(arrivals, 3)]
        assert len(names) == len(set(names)) == 3
        assert not set(names) & first
        time.sleep(0.05)
        assert arrivals.taken() == []


def test_an_unusable_image_is_named(tmp_path: Path) -> None:
    write(tmp_path, 1)
    with Arrivals(
        tmp_path, lambda only: list(read_samples(tmp_path, only=only)), {"000.png"}, 0.01
    ) as arrivals:
        (tmp_path / "labels" / "broken.txt").write_text("")
        (tmp_path / "images" / "broken.jpg").write_bytes(b"no image")
        with pytest.raises(InputError, match=r"broken\.jpg"):
            _awaited(arrivals, 9)


def test_an_unusable_image_is_skipped_once_and_those_after_it_arrive(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write(tmp_path / "set", 2)
    folder, first = tmp_path / "set", {"000.png"}
    (folder / "images" / "001.png").rename(tmp_path / "001.png")

    def read(only: Set[str]) -> CachedDataset:
        return load_cached_dataset(folder, 640, 0, skip_bad=True, only=only)

    with Arrivals(folder, read, first, 0.01) as arrivals:
        (folder / "images" / "broken.jpg").write_bytes(b"no image")
        time.sleep(0.2)
        assert arrivals.taken() == []
        shutil.copy(tmp_path / "001.png", folder / "images" / "part")
        (folder / "images" / "part").rename(folder / "images" / "001.png")
        assert [sample.name for sample in _awaited(arrivals, 1)] == ["001.png"]
    assert capsys.readouterr().err.count("broken.jpg") == 1


def test_pools_of_other_sizes_are_joined() -> None:
    small = load_pool([made(1)], CPU)
    image = made(2).image
    other = Sample("wide", image[:, ::-1].repeat(2, axis=1), made(2).classes, made(2).boxes)
    both = joined(small, load_pool([other, made(3)], CPU))
    rows, columns = made(1).image.shape[:2]
    assert both.images.shape == (3, 3, max(rows, image.shape[0]), 2 * image.shape[1])
    assert torch.equal(both.images[0, :, :rows, :columns], small.images[0, :, :rows, :columns])
    assert both.size[:2].tolist() == [[columns, rows], [2 * image.shape[1], image.shape[0]]]
    count = len(made(1).classes)
    assert torch.equal(both.boxes[0, :count], small.boxes[0, :count])
    assert (both.classes[0, count:] == NONE).all()


def test_batches_show_what_has_arrived(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(feed_module, "GROWTH_PASSES", 8)
    waiting = [[], [made(seed) for seed in range(3, 9)], []]
    feed = DeviceFeed(
        Mixture([[made(seed) for seed in range(3)], [made(9)]], [0.25]),
        CPU,
        3,
        DeviceAugmentation(1.4, 0.0),
        lambda: waiting.pop(0),
    )
    batches = list(feed.batches(parse_stages("64x64:24"), 4, 0))
    assert len(batches) == 6
    assert waiting == []
    assert len(feed.pools[0].images) == 9
    assert sorted(set(feed.places[feed.places[:, 0] == 0, 1])) == list(range(9))
    assert (feed.places[:, 0] == 1).mean() == pytest.approx(0.25, abs=0.05)


def test_the_command_trains_while_its_data_grow(tmp_path: Path) -> None:
    for name in ("train", "val"):
        write(tmp_path / "data" / name, 2)
    words = ["--data", str(tmp_path / "data"), "--views", "device", "--grow", "--stages", "64x64:4"]
    words += ["--batch", "2", "--threads", "1", "--device", "cpu"]
    weights = []
    for name, more in (("one", words), ("two", [word for word in words if word != "--grow"])):
        assert main([*more, "--out", str(tmp_path / name)]) == 0
        weights.append(torch.load(tmp_path / name / "checkpoint.pt", weights_only=True)["model"])
    assert all(torch.equal(weights[0][key], weights[1][key]) for key in weights[0])
