"""Readers of images, data sets and networks, each with a small valid file."""

import json
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np

from tests.fuzz import networks
from tests.fuzz.reader import Reader, data_file, picture, text_file

BOXES = np.array([[[10.0, 40.0, 60.0, 50.0], [20.0, 60.0, 40.0, 70.0]]], np.float32)
SCORES = np.array([[[0.9, 0.0], [0.0, 0.6]]], np.float32)


def _image(path: Path) -> object:
    from foreride.detector.data.image_io import read_image

    return read_image(path)


def _photo(path: Path) -> object:
    from foreride.scenarios.commands.inspect.calibrate import _photo

    return _photo(path)


RECORD = {
    "image": "a.png",
    "road": 1,
    "condition": {
        "light": "day", "weather": "dry", "low_sun": False, "motion_blur_px": 0.0, "surface": "asphalt",
        "verge": "grass", "surroundings": "rural",
    },
    "objects": [
        {"class": 0, "kind": "half_sine_bump", "paint": "none", "distance_m": 9.0, "in_ego_lane": True,
         "hidden": 0.0}
    ],
}  # fmt: skip
MANIFEST = {
    "counts": {"train": 1, "val": 0, "test": 0},
    "label_minimum": {"height_px": 4, "width_px": 8, "pixels": 30},
    "seed": 1,
    "hash": "abc",
}


def data_set(folder: Path) -> Path:
    """A rendered data set of one image, in the split `train`."""
    split = folder / "train"
    for inner in ("images", "labels", "lane"):
        (split / inner).mkdir(parents=True)
    (split / "images" / "a.png").write_bytes(picture(".png"))
    (split / "lane" / "a.png").write_bytes(bytes(cv2.imencode(".png", np.full((48, 64), 255, np.uint8))[1]))
    (split / "labels" / "a.txt").write_text("0 0.5 0.5 0.25 0.25\n")
    (split / "objects.jsonl").write_text(json.dumps(RECORD) + "\n")
    (folder / "dataset.json").write_text(json.dumps(MANIFEST))
    return split


def _in_set(name: str) -> Callable[[Path], Path]:
    return lambda folder: data_set(folder) / name


def _split_of(path: Path) -> Path:
    return path.parent if (path.parent / "images").is_dir() else path.parent.parent


def _labels(path: Path) -> object:
    from foreride.detector.data.yolo_folder import read_labels

    return read_labels(path)


def _records(path: Path) -> object:
    from foreride.detector.data.yolo_folder import read_records

    return read_records(path.parent)


def _evaluated(path: Path) -> object:
    from foreride.detector.detections import Detections
    from foreride.detector.evaluation.evaluate import evaluate

    found = Detections(BOXES[0], SCORES[0].max(1), np.array([0, 1]))
    return evaluate(_split_of(path), lambda image: found, 0.5)


def _card(path: Path) -> object:
    from foreride.road.dataset.dataset_card import write_card

    return write_card(path.parent if path.name == "dataset.json" else path.parent.parent, {})


def _boxes(path: Path) -> object:
    from foreride.road.dataset.label_statistics import box_statistics

    return box_statistics(_split_of(path))


COCO = {
    "images": [{"id": 1, "file_name": "a.png", "width": 64, "height": 48}],
    "annotations": [{"id": 1, "image_id": 1, "category_id": 1, "bbox": [4, 4, 20, 10], "iscrowd": 0}],
    "categories": [{"id": 1, "name": "pothole"}],
}


def _coco_file(folder: Path) -> Path:
    (folder / "a.png").write_bytes(picture(".png"))
    return text_file("coco.json", json.dumps(COCO))(folder)


def _coco(path: Path) -> object:
    from foreride.detector.data.yolo_coco import read_coco

    return read_coco(path, path.parent, {})


HISTORY = {"passes": 10, "size": "64x64", "loss": {"box": 1.0}, "map50": 0.5, "map50_95": 0.3, "recall": 0.5}


def _curves(path: Path) -> object:
    from foreride.detector.evaluation.plots import write_curves

    return write_curves(path.parent)


def _weights_file(folder: Path) -> Path:
    import torch

    from foreride.detector.network.checkpoint import save_weights

    torch.manual_seed(0)
    save_weights(folder / "weights.pt", torch.nn.Linear(2, 2), {"model": "linear", "passes": 1})
    return folder / "weights.pt"


def _weights(path: Path) -> object:
    import torch

    from foreride.detector.network.checkpoint import load_weights

    return load_weights(path, torch.nn.Linear(2, 2))


def _network_file(folder: Path) -> Path:
    return networks.write(folder / "network.onnx", BOXES, SCORES)


def _network(path: Path) -> object:
    from foreride.detector.runtime import Detector

    return Detector(path)(np.zeros((64, 96, 3), np.uint8))


IMAGE_READERS: dict[str, Reader] = {
    "image.png": Reader(data_file("image.png", picture(".png")), _image),
    "image.jpg": Reader(data_file("image.jpg", picture(".jpg")), _image),
    "image.webp": Reader(data_file("image.webp", picture(".webp")), _image),
    "image.bmp": Reader(data_file("image.bmp", picture(".bmp")), _image),
    "photograph": Reader(data_file("photo.jpg", picture(".jpg")), _photo),
    "labels": Reader(text_file("labels.txt", "0 0.5 0.5 0.25 0.25\n1 0.2 0.2 0.1 0.1\n"), _labels),
    "records": Reader(_in_set("objects.jsonl"), _records),
    "evaluated labels": Reader(_in_set("labels/a.txt"), _evaluated),
    "evaluated records": Reader(_in_set("objects.jsonl"), _evaluated),
    "lane mask": Reader(_in_set("lane/a.png"), _evaluated),
    "card's manifest": Reader(_in_set("../dataset.json"), _card),
    "card's records": Reader(_in_set("objects.jsonl"), _card),
    "boxes' labels": Reader(_in_set("labels/a.txt"), _boxes),
    "boxes' image": Reader(_in_set("images/a.png"), _boxes),
    "coco": Reader(_coco_file, _coco),
    "history": Reader(text_file("history.jsonl", json.dumps(HISTORY) + "\n"), _curves),
    "weights": Reader(_weights_file, _weights),
    "network": Reader(_network_file, _network),
}
