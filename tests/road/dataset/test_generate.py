"""Data set generation: reproducible to the byte, split by road, labels that fit their images."""

import json
from pathlib import Path

import cv2
import numpy as np
import pytest

from foreride.files.errors import InputError
from foreride.road.dataset.generate import main, write_dataset
from foreride.road.dataset.label_views import SPLITS, VIEWS_PER_ROAD, with_distractors
from foreride.road.dataset.random_scenes import MAX_APPROACH_M, MIN_APPROACH_M, random_road
from foreride.road.features.feature import Feature
from foreride.road.render.appearance import random_appearance
from foreride.road.render.scene import MAX_HIDDEN

COUNTS = {"train": VIEWS_PER_ROAD + 2, "val": 3, "test": 3}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("data") / "set"
    write_dataset(out, COUNTS, seed=3)
    return out


def rows_of(folder: Path, split: str) -> list[dict]:
    return [json.loads(line) for line in (folder / split / "objects.jsonl").read_text().splitlines()]


def test_counts_and_manifest(folder: Path) -> None:
    manifest = json.loads((folder / "dataset.json").read_text())
    assert manifest["names"] == ["speed_bump", "pothole"]
    assert manifest["counts"] == COUNTS
    assert manifest["seed"] == 3
    for split, count in COUNTS.items():
        images = {p.stem for p in (folder / split / "images").iterdir()}
        assert len(images) == count
        assert images == {p.stem for p in (folder / split / "labels").iterdir()}
        assert images == {Path(row["image"]).stem for row in rows_of(folder, split)}


def test_same_seed_same_hash_whatever_the_workers(folder: Path, tmp_path: Path) -> None:
    again = write_dataset(tmp_path / "again", COUNTS, seed=3, workers=2)
    assert again == json.loads((folder / "dataset.json").read_text())
    other = write_dataset(tmp_path / "other", {"val": 2}, seed=4)
    assert other["hash"] != again["hash"]


def test_splits_show_different_roads(folder: Path) -> None:
    poses = {split: {json.dumps(row["pose"]) for row in rows_of(folder, split)} for split in COUNTS}
    assert not poses["train"] & poses["val"]
    assert not poses["train"] & poses["test"]
    assert not poses["val"] & poses["test"]


def test_labels_are_the_objects_and_lie_in_the_image(folder: Path) -> None:
    boxes_checked = 0
    for split in COUNTS:
        for row in rows_of(folder, split):
            image = cv2.imread(str(folder / split / "images" / row["image"]))
            assert image is not None
            height, width = image.shape[:2]
            lines = (folder / split / "labels" / f"{Path(row['image']).stem}.txt").read_text().splitlines()
            assert (width, height) == (640, 384)
            assert len(lines) == len(row["objects"])
            for line, obj in zip(lines, row["objects"], strict=True):
                cls, *values = line.split()
                cx, cy, w, h = map(float, values)
                box = np.array([cx - w / 2, cy - h / 2, cx + w / 2, cy + h / 2])
                box *= (width, height, width, height)
                np.testing.assert_allclose(box, obj["box"], atol=0.01)
                assert int(cls) == obj["class"]
                assert box.min() >= -0.01
                assert box[2] <= width + 0.01
                assert box[3] <= height + 0.01
                assert obj["height_px"] >= 3
                boxes_checked += 1
    assert boxes_checked > 5


def test_splits_share_no_image(folder: Path) -> None:
    assert len({row["road"] for row in rows_of(folder, "train")}) == 2
    images = {split: {p.read_bytes() for p in (folder / split / "images").iterdir()} for split in COUNTS}
    assert not images["train"] & (images["val"] | images["test"])


def test_objects_are_at_most_partly_hidden_and_carry_kind_and_condition(folder: Path) -> None:
    for split in COUNTS:
        for row in rows_of(folder, split):
            assert {"light", "weather", "low_sun", "motion_blur_px"} <= set(row["condition"])
            for obj in row["objects"]:
                assert 0 <= obj["hidden"] <= MAX_HIDDEN
                assert obj["class"] == (obj["kind"] == "pothole")
                assert (obj["paint"] is None) == (obj["class"] == 1)


def test_the_card_counts_what_is_there(folder: Path) -> None:
    card = (folder / "README.md").read_text()
    for split, count in COUNTS.items():
        rows = rows_of(folder, split)
        classes = [obj["class"] for row in rows for obj in row["objects"]]
        empty = sum(not row["objects"] for row in rows)
        roads = len({row["road"] for row in rows})
        line = f"| {split} | {roads} | {count} | {empty} | {classes.count(0)} | {classes.count(1)} |"
        assert line in card
    assert "varma_marked" in card


def test_a_full_folder_is_refused(folder: Path) -> None:
    with pytest.raises(InputError, match="already holds a data set"):
        write_dataset(folder, {"train": 1}, seed=0)
    assert main(["--out", str(folder)]) == 2


def test_bad_counts_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="counts must map"):
        write_dataset(tmp_path / "x", {"training": 1}, seed=0)
    with pytest.raises(InputError, match="counts must map"):
        write_dataset(tmp_path / "x", {"train": -1}, seed=0)


def features_of(seed: int, split: str, number: int) -> tuple[Feature, ...]:
    """Features of one road of a set, drawn again."""
    rng = np.random.default_rng((seed, SPLITS.index(split), number))
    return random_road(rng, random_appearance(rng)).features


def lies_ahead(feature: Feature, positions: list[float]) -> bool:
    """True if a feature is within the approach distances of all `places`."""
    return all(MIN_APPROACH_M - 1e-9 <= feature.start_m - x <= MAX_APPROACH_M + 1e-9 for x in positions)


@pytest.mark.parametrize("approach", [True, False])
def test_an_approach_comes_nearer_to_one_feature(tmp_path: Path, approach: bool) -> None:
    write_dataset(tmp_path / "set", {"val": 3 * VIEWS_PER_ROAD}, seed=5, approach=approach)
    rows = rows_of(tmp_path / "set", "val")
    for number in range(3):
        positions = [row["pose"]["x"] for row in rows if row["road"] == number]
        assert positions == sorted(positions)
        ahead_of_all = [f for f in features_of(5, "val", number) if lies_ahead(f, positions)]
        assert bool(ahead_of_all) == approach
    if approach:
        near = [min((o["distance_m"] for o in row["objects"]), default=np.inf) for row in rows]
        assert np.median(near) < MAX_APPROACH_M
    usual = sum(row["camera"]["focal_px"] == 457.0 for row in rows)
    assert (usual > len(rows) / 2) == approach


def test_plain_roads_have_nothing_to_find_but_much_that_looks_like_it(tmp_path: Path) -> None:
    write_dataset(tmp_path / "set", {"train": 2 * VIEWS_PER_ROAD}, seed=5, plain=True)
    rows = rows_of(tmp_path / "set", "train")
    assert len(rows) == 2 * VIEWS_PER_ROAD
    assert all(row["objects"] == [] for row in rows)
    assert all(path.read_text() == "" for path in (tmp_path / "set/train/labels").iterdir())
    assert json.loads((tmp_path / "set/dataset.json").read_text())["plain"] is True
    rng = np.random.default_rng(0)
    usual = [random_appearance(rng) for _ in range(200)]
    full = [with_distractors(look, rng) for look in usual]
    for density in ("patches", "distractors"):
        assert np.mean([getattr(look, density) for look in full]) > 0.6
        assert np.mean([getattr(look, density) for look in usual]) < 0.6
    assert [look.light for look in full] == [look.light for look in usual]
